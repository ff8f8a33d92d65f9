// The exercises of the page as scenes (TOML, docs/file-formats.md).

export const EXERCISES = {
  press: {organ: 'gallbladder', tool: 'curved-forceps', direction: 'press', name: 'Gallbladder pressed with curved forceps'},
  pull: {organ: 'heart', tool: 'straight-forceps', direction: 'pull', name: 'Heart pulled with straight forceps'},
  palpate: {organ: 'liver', tool: 'sphere:5', direction: 'press', name: 'Liver palpated with a 5 mm ball'},
};

/** Tissue numbers with sliders, by their keys in tissue files. The same ranges suit all four organs. */
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

export const NOISE = {enabled: true, gain: 5e-5, threshold: 5e-3};  // N m, m

const LUMPS = 3;
export const TOLERANCE = 10e-3;  // m: a mark within it of the point above a lump finds the lump

/** Text of a scene. @param seed hides the lumps elsewhere @param haply {grip}: an Inverse3 holds the tool */
export function sceneText(task, seed, haply) {
  const {organ, tool, name} = EXERCISES[task];
  const lines = ['[scene]', `name = "${name}"`, `task = "${task}"`, `seed = ${seed}`,
    '[noise]', `enabled = ${NOISE.enabled}`, `gain_N_m = ${NOISE.gain}`, `threshold_mm = ${1e3 * NOISE.threshold}`,
    '[organ]', `mesh = "${organ}"`, '[tool]', `mesh = "${tool}"`];
  // Without a grip the handle's orientation is the identity, and the instrument would point up.
  if (haply && !haply.grip) lines.push('mount = { rotation_deg = [180, 0, 0] }');
  if (haply) lines.push('[device]', 'kind = "haply"');
  if (task === 'palpate') {
    lines.push('[search]', `lumps = ${LUMPS}`, 'preset = "nodule"', 'radius_mm = 6', 'depth_mm = 9',
      `tolerance_mm = ${1e3 * TOLERANCE}`);
  }
  return lines.join('\n') + '\n';
}
