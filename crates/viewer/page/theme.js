// Colours, for light and dark. sRGB in 0…1 for the graphics card, as CSS for the canvas from above.

const THEMES = {
  light: {
    sky: [0.62, 0.64, 0.67], bounce: [0.36, 0.34, 0.32], sun: [0.62, 0.6, 0.56],
    fixture: [0.9, 0.89, 0.86], wall: [0.8, 0.8, 0.79], other: [0.9, 0.86, 0.74], robot: [0.86, 0.87, 0.88],
    ground: [0.2, 0.22, 0.26, 0.2], shade: [0.1, 0.11, 0.14, 0.2], edge: [0.12, 0.14, 0.18], edgeAlpha: 0.42, place: 0.1,
  },
  dark: {
    sky: [0.46, 0.49, 0.54], bounce: [0.2, 0.2, 0.21], sun: [0.6, 0.58, 0.54],
    fixture: [0.42, 0.44, 0.47], wall: [0.5, 0.53, 0.57], other: [0.78, 0.75, 0.65], robot: [0.8, 0.82, 0.84],
    ground: [0.8, 0.85, 0.95, 0.13], shade: [0, 0, 0, 0.42], edge: [0.02, 0.025, 0.035], edgeAlpha: 0.6, place: 0.16,
  },
};

const TARGET_COLOUR = [0.2, 0.45, 0.9];
const FIRST_REMOVED = [0.95, 0.6, 0.22];
const LAST_REMOVED = [0.82, 0.25, 0.2];

/** The hand's links, where the URDF gives them no colour. */
const HAND_COLOUR = [0.42, 0.45, 0.5];

const css = (c, alpha = 1) => `rgb(${c.slice(0, 3).map((v) => Math.round(v * 255)).join(' ')} / ${alpha})`;

/** By id: the colour and place in the removal order of every object that moves, or is wanted; for a goal of its own, in the order of first moves. */
function removalColours(plan) {
  const removed = [...new Set(plan.goal ? plan.steps.map((step) => step.object) : plan.removed ?? [])];
  const before = removed.filter((id) => id !== plan.scene.target);
  const colours = new Map();
  removed.forEach((id, i) => {
    const s = before.length > 1 ? before.indexOf(id) / (before.length - 1) : 0.5;
    const colour = id === plan.scene.target ? TARGET_COLOUR : FIRST_REMOVED.map((v, k) => mix(v, LAST_REMOVED[k], s));
    colours.set(id, { colour, order: i + 1 });
  });
  if (!colours.has(plan.scene.target)) colours.set(plan.scene.target, { colour: TARGET_COLOUR, order: 0 });
  return colours;
}

/** Green, amber, orange, red: nothing, one, two, three or more objects in the way. */
const COLLISION_COLOURS = [[0.16, 0.62, 0.45], [0.9, 0.68, 0.16], [0.92, 0.47, 0.16], [0.8, 0.22, 0.2]];
const collisionColour = (names) => COLLISION_COLOURS[Math.min(names?.length ?? 0, COLLISION_COLOURS.length - 1)];

/** `dark` or `light`: what the reader chose, else what the system says. */
function currentTheme() {
  const chosen = document.documentElement.dataset.theme;
  if (chosen) return chosen;
  return window.matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
}
