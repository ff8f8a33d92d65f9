// Scenes, organs and tissues by address, and files of this computer. Files are read as numbers and texts; none is run.

const LIMITS = {text: 1 << 20, mesh: 64 << 20, csv: 64 << 20};  // bytes
const MESHES = /\.(stl|obj|ply|off|vtk|vtp|msh|glb|gltf|3ds|dae)$/i;
const NAMES_FILE = /"([^"\n]+\.(?:stl|obj|ply|off|vtk|msh|csv|toml))"/gi;  // in a scene
const MOST_FILES = 16;  // of a scene

export class LoadError extends Error {}

const megabytes = bytes => `${(bytes / (1 << 20)).toFixed(0)} MiB`;
const limitOf = name => MESHES.test(name) ? LIMITS.mesh : /\.csv$/i.test(name) ? LIMITS.csv : LIMITS.text;
const isAddress = value => /[/.]/.test(value);

/** Bytes of an address. @param field for messages @param limit bytes */
export async function bytesOf(address, field, limit) {
  const {protocol} = new URL(address);
  if (protocol !== 'http:' && protocol !== 'https:') throw new LoadError(`${field} = ${address}: must be an address that begins with http:// or https://`);
  let answer;
  try {
    answer = await fetch(address, {credentials: 'omit', referrerPolicy: 'no-referrer'});
  } catch {
    throw new LoadError(`${field} = ${address}: cannot be read. The server is not there, or does not allow other pages to read it (CORS)`);
  }
  if (!answer.ok) throw new LoadError(`${field} = ${address}: cannot be read: HTTP status ${answer.status}`);
  const refuse = () => { throw new LoadError(`${field} = ${address}: is larger than ${megabytes(limit)}`); };
  if (Number(answer.headers.get('content-length')) > limit) refuse();
  const parts = [];
  let size = 0;
  for (const reader = answer.body.getReader(); ;) {
    const {done, value} = await reader.read();
    if (done) break;
    size += value.length;
    if (size > limit) {
      reader.cancel();
      refuse();
    }
    parts.push(value);
  }
  const bytes = new Uint8Array(size);
  let at = 0;
  for (const part of parts) {
    bytes.set(part, at);
    at += part.length;
  }
  return bytes;
}

/** Files that a scene names, from the folder of the scene. A file that is not there is left to the reader of the scene. */
async function filesOf(text, base) {
  const files = {};
  const names = new Set([...text.matchAll(NAMES_FILE)].map(([, name]) => name));
  if (names.size > MOST_FILES) throw new LoadError(`scene: names ${names.size} files, must be at most ${MOST_FILES}`);
  for (const name of names) {
    if (name.startsWith('/') || name.split('/').some(part => part === '' || part === '.' || part === '..') || name.includes(':')) continue;
    try {
      files[name] = await bytesOf(new URL(name, base).href, 'scene', limitOf(name));
    } catch (error) {
      if (!/HTTP status 404/.test(error.message)) throw error;
    }
  }
  return files;
}

/** The request of a built-in scene. @param folder address of the page's copies of the files that scenes name */
export async function builtinRequest(scenes, name, folder) {
  const scene = scenes.find(one => one.name === name);
  if (!scene) throw new LoadError(`scene = ${name}: must be ${scenes.map(one => one.name).join(', ')}, or an address that ends in .toml`);
  return {builtin: name, text: null, files: await filesOf(scene.toml, folder), link: {scene: name}};
}

/**
 * The request that the address of the page asks for: ?scene=, ?organ=, ?unit=, ?tissue=, ?seed=; null without any.
 * @param search of the address @param scenes Palpate.scenes @param page address of the page
 */
export async function requestOf(search, scenes, page) {
  const given = new URLSearchParams(search), fields = ['scene', 'organ', 'unit', 'tissue', 'seed'];
  for (const name of given.keys()) {
    if (!fields.includes(name)) throw new LoadError(`${name}: unknown in the page\u2019s address, must be one of ${fields.join(', ')}`);
  }
  if (!fields.some(field => given.has(field))) return null;
  const scene = given.get('scene') ?? 'press';
  let request;
  if (isAddress(scene)) {
    if (!/\.toml$/i.test(new URL(scene, page).pathname)) throw new LoadError(`scene = ${scene}: must be a built-in scene, or an address that ends in .toml`);
    const address = new URL(scene, page).href;
    const text = new TextDecoder().decode(await bytesOf(address, 'scene', LIMITS.text));
    request = {builtin: null, text, files: await filesOf(text, address), link: {scene}};
  } else {
    request = await builtinRequest(scenes, scene, new URL('scenes/', page));
  }
  for (const field of ['organ', 'tissue']) {
    const value = given.get(field);
    if (!value) continue;
    request.link[field] = value;
    request[field] = value;
    if (!isAddress(value)) continue;
    const address = new URL(value, page), name = address.pathname.split('/').at(-1);
    request.files = {...request.files, [name]: await bytesOf(address.href, field, limitOf(name))};
    request[field] = name;
  }
  if (given.has('unit')) request.link.unit = request.organUnit = given.get('unit');
  if (given.has('seed')) request.link.seed = request.seed = given.get('seed');
  return request;
}

/** The address of the page that opens what is open; null: a file of this computer has none. */
export function linkTo(page, {link}, seed) {
  if (!link) return null;
  const address = new URL(page);
  address.hash = '';
  address.search = new URLSearchParams(seed === undefined ? link : {...link, seed});
  return address.href;
}

/**
 * What dropped files ask for: {recording: text} or {request}. @param open request of the open scene: a mesh or a tissue
 * goes into it @param unitOf asks for the unit of a mesh
 */
export async function requestOfFiles(list, open, unitOf) {
  const files = [...list], find = test => files.find(({name}) => test.test(name));
  const bytes = async file => {
    if (file.size > limitOf(file.name)) throw new LoadError(`${file.name}: is larger than ${megabytes(limitOf(file.name))}`);
    return new Uint8Array(await file.arrayBuffer());
  };
  const text = async file => new TextDecoder().decode(await bytes(file));
  const recording = find(/\.csv$/i), toml = find(/\.toml$/i), mesh = find(MESHES);
  if (find(/\.(h5|hdf5)$/i)) {
    throw new LoadError('This page does not read HDF5. Make a CSV of the recording: palpate export RECORDING.h5 --csv RECORDING.csv');
  }
  if (toml) {
    const content = await text(toml), named = {};
    for (const file of files) if (file !== toml) named[file.name] = await bytes(file);
    const isTissue = /^\[tissue\]/m.test(content) && !/^\[(organ|scene|\[?tool)\]/m.test(content);
    if (isTissue) return {request: {...open, files: {...open.files, [toml.name]: content}, tissue: toml.name, link: null}};
    return {request: {builtin: null, text: content, files: named, link: null}};
  }
  if (mesh) {
    const unit = await unitOf(mesh.name);
    if (!unit) return {};
    return {request: {...open, files: {...open.files, [mesh.name]: await bytes(mesh)}, organ: mesh.name, organUnit: unit, link: null}};
  }
  if (recording) return {recording: await text(recording)};
  throw new LoadError(`${files[0]?.name ?? 'file'}: this page opens scenes and tissues (.toml), meshes and recordings as CSV`);
}
