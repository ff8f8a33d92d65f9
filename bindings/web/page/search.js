// The search for hidden lumps: marks, and the score at its end (docs/lumps.md).
import {norm, sub} from './vectors.js';

/** The vertex of the rest surface nearest to a point [m], organ frame. The organ's edges are 1 to 3 mm long. */
export function surfacePoint(positions, point) {
  let best = Infinity, at = 0;
  for (let i = 0; i < positions.length; i += 3) {
    const square = (positions[i] - point[0]) ** 2 + (positions[i + 1] - point[1]) ** 2 + (positions[i + 2] - point[2]) ** 2;
    if (square < best) [best, at] = [square, i];
  }
  return Array.from(positions.subarray(at, at + 3));
}

/**
 * Score of a search. A mark belongs to the nearest lump if it is within the tolerance [m].
 * @param lumps points of the surface above the lumps @param marks points of the surface, in their order
 * @return found, missed, wrong (marks far from every lump), repeated, error [m]: mean distance of found lumps to their
 *   first marks, or null; kinds: 'found' or 'false' per mark
 */
export function scoreOf(lumps, marks, tolerance) {
  const first = new Map(), kinds = [];
  let wrong = 0, repeated = 0;
  for (const mark of marks) {
    const distances = lumps.map(lump => norm(sub(lump, mark)));
    const nearest = distances.indexOf(Math.min(...distances));
    const hit = nearest >= 0 && distances[nearest] <= tolerance;
    kinds.push(hit ? 'found' : 'false');
    if (!hit) wrong++;
    else if (first.has(nearest)) repeated++;
    else first.set(nearest, distances[nearest]);
  }
  const errors = [...first.values()];
  return {found: first.size, missed: lumps.length - first.size, wrong, repeated, kinds,
    error: errors.length ? errors.reduce((a, b) => a + b) / errors.length : null};
}
