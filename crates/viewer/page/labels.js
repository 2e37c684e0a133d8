// Marks that float over the picture: removal numbers on what is moved, names on request.

function createLabels(layer, bodies) {
  const marks = bodies.objects.map((object) => {
    const element = document.createElement('span');
    element.className = object.order ? 'mark moved' : object.target ? 'mark moved' : 'mark';
    if (object.colour) element.style.setProperty('--mark', css(object.colour));
    layer.append(element);
    return { object, element };
  });

  return (stage, state, names) => {
    for (const { object, element } of marks) {
      const number = object.order || (object.target ? '◎' : '');
      element.textContent = names ? (object.order ? `${object.order} · ${object.id}` : object.id) : number;
      const { pose } = state.objects.get(object.id);
      const top = worldBounds([{ bounds: object.bounds, pose }]).max[2];
      const at = element.textContent === '' ? null : stage.onCanvas([pose.position[0], pose.position[1], top + 0.02]);
      element.hidden = !at;
      if (at) element.style.transform = `translate(${at[0].toFixed(1)}px, ${at[1].toFixed(1)}px) translate(-50%, -100%)`;
    }
  };
}
