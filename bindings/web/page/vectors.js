// Vectors of three numbers and unit quaternions [w, x, y, z], as plain arrays.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const sub = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const scaled = (s, a) => [s * a[0], s * a[1], s * a[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const norm = a => Math.hypot(a[0], a[1], a[2]);
export const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

/** The vector in the frame that the rotation q brings to the vector's frame. */
export function rotatedBack([w, x, y, z], v) {
  const t = [2 * (z * v[1] - y * v[2]), 2 * (x * v[2] - z * v[0]), 2 * (y * v[0] - x * v[1])];
  return [v[0] + w * t[0] + z * t[1] - y * t[2], v[1] + w * t[1] + x * t[2] - z * t[0],
    v[2] + w * t[2] + y * t[0] - x * t[1]];
}

/** Place of a point in a picture: 0 to 1 from its upper left corner; null: behind the camera. @param aspect width over height */
export function placeOf({eye, target, up, verticalViewDeg}, aspect, point) {
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const unit = v => scaled(1 / norm(v), v);
  const back = unit(sub(eye, target)), right = unit(cross(up, back)), way = sub(point, eye), far = -dot(way, back);
  if (far < 1e-3) return null;
  const per = 1 / (2 * Math.tan(verticalViewDeg * Math.PI / 360) * far);
  return {x: 0.5 + per * dot(way, right) / aspect, y: 0.5 - per * dot(way, cross(back, right))};
}
