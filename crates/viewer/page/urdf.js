// A URDF as plain data: links with their shapes, joints with origins, axes and mimics. Reads the
// text with the browser's own XML parser; anything unreadable becomes an Error with a sentence.

function parseUrdf(text) {
  const document_ = new DOMParser().parseFromString(text ?? '', 'text/xml');
  const robot = document_.documentElement;
  if (document_.querySelector('parsererror') || robot?.nodeName !== 'robot')
    throw new Error('The plan’s robot.urdf is not a readable URDF.');

  const children = (element, name) => [...(element?.children ?? [])].filter((e) => e.nodeName === name);
  const child = (element, name) => children(element, name)[0];
  const number = (element, name, fallback) => {
    const value = parseFloat(element?.getAttribute(name) ?? '');
    return Number.isFinite(value) ? value : fallback;
  };
  const numbers = (element, name, fallback) => {
    const values = (element?.getAttribute(name) ?? '').trim().split(/\s+/).map(Number);
    return values.length === fallback.length && values.every(Number.isFinite) ? values : fallback;
  };
  const origin = (element) => {
    const tag = child(element, 'origin');
    return { position: numbers(tag, 'xyz', [0, 0, 0]), quaternion: quatFromRpy(numbers(tag, 'rpy', [0, 0, 0])) };
  };

  const palette = {};
  const colourOf = (material) => {
    const rgba = child(material, 'color') && numbers(child(material, 'color'), 'rgba', [0.7, 0.7, 0.7, 1]);
    return rgba ? rgba.slice(0, 3) : null;
  };
  for (const material of children(robot, 'material')) palette[material.getAttribute('name')] = colourOf(material);

  const shape = (element) => {
    const kind = child(element, 'geometry')?.children[0];
    const material = child(element, 'material');
    const colour = material ? (colourOf(material) ?? palette[material.getAttribute('name')] ?? null) : null;
    const base = { pose: origin(element), colour };
    switch (kind?.nodeName) {
      case 'box': return { ...base, kind: 'box', size: numbers(kind, 'size', [0, 0, 0]) };
      case 'sphere': return { ...base, kind: 'sphere', radius: number(kind, 'radius', 0) };
      case 'cylinder': case 'capsule':
        return { ...base, kind: kind.nodeName, radius: number(kind, 'radius', 0), height: number(kind, 'length', 0) };
      case 'mesh': return { ...base, kind: 'mesh', uri: kind.getAttribute('filename'), scale: numbers(kind, 'scale', [1, 1, 1]) };
      default: return null;
    }
  };
  const shapes = (link, name) => children(link, name).map(shape).filter(Boolean);

  const links = children(robot, 'link').map((link) => ({
    name: link.getAttribute('name'),
    visuals: shapes(link, 'visual'),
    collisions: shapes(link, 'collision'),
  }));
  const joints = children(robot, 'joint').map((joint) => {
    const mimic = child(joint, 'mimic');
    return {
      name: joint.getAttribute('name'),
      type: joint.getAttribute('type'),
      parent: child(joint, 'parent')?.getAttribute('link'),
      child: child(joint, 'child')?.getAttribute('link'),
      origin: origin(joint),
      axis: normalized(numbers(child(joint, 'axis'), 'xyz', [1, 0, 0])),
      mimic: mimic
        ? { joint: mimic.getAttribute('joint'), multiplier: number(mimic, 'multiplier', 1), offset: number(mimic, 'offset', 0) }
        : null,
    };
  });
  return { name: robot.getAttribute('name') ?? '', links, joints };
}
