// Buttons, slider and keys.

function createControls({ timeline, stage, above, options, setTime, toggle, invalidate, jump }) {
  const slider = byId('slider');
  const playButton = byId('play');
  slider.max = timeline.duration;
  slider.step = 'any';
  document.body.classList.toggle('still', timeline.duration <= 0);

  slider.addEventListener('input', () => setTime(Number(slider.value)));
  playButton.addEventListener('click', toggle);
  byId('previous').addEventListener('click', () => jump(-1));
  byId('next').addEventListener('click', () => jump(1));

  for (const button of document.querySelectorAll('[data-view]')) {
    button.addEventListener('click', () => stage?.camera.moveTo(stage.views[button.dataset.view]));
  }
  const pressed = (button, on) => button.setAttribute('aria-pressed', String(on));
  for (const button of document.querySelectorAll('[data-option]')) {
    button.hidden = button.dataset.option === 'showPath' && timeline.duration <= 0;
    pressed(button, options[button.dataset.option]);
    button.addEventListener('click', () => {
      options[button.dataset.option] = !options[button.dataset.option];
      pressed(button, options[button.dataset.option]);
      invalidate();
    });
  }
  for (const button of document.querySelectorAll('[data-layer]')) {
    const layer = button.dataset.layer;
    const given = { roadmap: above.hasRoadmap, path: above.hasRoadmap, graph: above.hasGraph }[layer] ?? true;
    button.hidden = !given;
    pressed(button, above.layers[layer]);
    button.addEventListener('click', () => {
      above.layers[layer] = !above.layers[layer];
      pressed(button, above.layers[layer]);
      above.redraw();
    });
  }
  byId('legend').hidden = !above.hasRoadmap && !above.hasGraph;
  let whole = false;
  byId('whole').addEventListener('click', () => {
    whole = !whole;
    pressed(byId('whole'), whole);
    above.fit(whole);
  });
  byId('theme').addEventListener('click', () => {
    document.documentElement.dataset.theme = currentTheme() === 'dark' ? 'light' : 'dark';
    invalidate();
  });

  const typing = (target) => target.matches?.('select, input:not([type=range]), textarea');
  document.addEventListener('keydown', (event) => {
    if (typing(event.target) || event.ctrlKey || event.metaKey || event.altKey) return;
    const act = {
      ' ': toggle,
      ArrowRight: () => jump(1), ArrowLeft: () => jump(-1),
      Home: () => setTime(0), End: () => setTime(timeline.duration),
    }[event.key];
    if (!act) return;
    if (event.key === ' ' && event.target.matches?.('button') && event.target !== playButton) return;
    event.preventDefault();
    act();
  });

  function show(plan, state, playing) {
    const { segment, t } = state;
    slider.value = t;
    slider.style.setProperty('--done', timeline.duration > 0 ? t / timeline.duration : 0);
    playButton.classList.toggle('playing', playing);
    playButton.setAttribute('aria-label', playing ? 'Pause' : 'Play');
    byId('clock').textContent = `${t.toFixed(1)} / ${timeline.duration.toFixed(1)} s`;
    if (!segment) {
      byId('step-words').replaceChildren(element('b', '', 'No motion'), ' – the robot stands at its start');
      return;
    }
    const order = `${segment.stepIndex + 1} of ${plan.steps.length}`;
    byId('step-words').replaceChildren(`${order} · `, element('b', '', segment.step.object), ` · ${segment.kind} – `, element('span', 'quiet', doing(plan, segment)));
    slider.setAttribute('aria-valuetext', `${t.toFixed(1)} seconds, ${segment.step.object}, ${segment.kind}`);
  }

  return { show, speed: () => Number(byId('speed').value) };
}
