// What the page opens: a built-in scene, a file of this computer, or an address.

/** The three exercises of the header, by the task of their scenes. */
export const EXERCISES = {
  press: {scene: 'press', organ: 'gallbladder'},
  pull: {scene: 'pull', organ: 'heart'},
  palpate: {scene: 'find-the-lump', organ: 'liver'},
};

/** Tissue numbers with sliders, by their keys in tissue files. The same ranges suit all built-in organs. */
export const TISSUE_SLIDERS = [
  {field: 'k1_N_per_m', label: 'Stiffness of the surface', unit: 'N/m', low: 5, high: 80, step: 0.5, decimals: 1,
    meaning: 'k\u2081, spring constant of the first layer'},
  {field: 'beta', label: 'Softness of deeper layers', unit: '', low: 0.8, high: 6, step: 0.05, decimals: 2,
    meaning: '\u03b2: layer i is exp((i \u2212 1)/\u03b2) times as stiff as the first'},
  {field: 'contact.friction', label: 'Friction', unit: '', low: 0, high: 1, step: 0.01, decimals: 2,
    meaning: 'Coulomb\u2019s coefficient between tool and tissue'},
  {field: 'contact.grip_limit_N', label: 'Grip limit', unit: 'N', low: 0.5, high: 10, step: 0.1, decimals: 1,
    meaning: 'pull force at which the jaws lose the tissue', task: 'pull'},
];

/** The text of a request's scene. @param scenes Palpate.scenes */
export function textOf(scenes, {builtin, text}) {
  return builtin ? scenes.find(({name}) => name === builtin).toml : text;
}

/** Whether a request has a tissue of its own, from a file, which may have the name of a built-in one. */
export const hasOwnTissue = ({files = {}}) => Object.keys(files).some(name => /\.toml$/i.test(name));

/** The organ that a scene names, for messages. */
export function organIn(text) {
  return /^\[organ\][^[]*?^mesh\s*=\s*"([^"]+)"/m.exec(text)?.[1] ?? 'organ';
}

/**
 * What Palpate.open() needs for a request.
 * @param request {builtin: name or null, text: TOML or null, files, organ, organUnit, tissue, seed}
 * @param haply null, or {grip}: an Inverse3 holds the tool
 */
export function optionsOf(scenes, request, haply) {
  const {files = {}, organ, organUnit, tissue, seed} = request;
  let scene = textOf(scenes, request);
  // Without a grip the handle's orientation is the identity, and the instrument would point up.
  if (haply && !haply.grip && !/^mount\s*=/m.test(scene)) {
    scene = scene.replace(/^\[tool\]$/m, '[tool]\nmount = { rotation_deg = [180, 0, 0] }');
  }
  return {scene, files, organ, organUnit, tissue, seed, device: haply ? 'haply' : undefined};
}
