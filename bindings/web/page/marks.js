// Force arrows, scale bar and axes over the picture, as the program's window has them.

const LETTERS = 14;  // CSS pixels
const COLOURS = {
  text: '#e8eaec', force: '#f5a852', x: '#ee6b66', y: '#8cd173', z: '#7ba8fa', plate: '#121417c7', steel: '#edf2f7',
  layer1: '#d6a187', layer2: '#e8cc78', layer3: '#ba695c', layer4: '#cc9682', layer5: '#dbd6c2', layer6: '#9e5c5e',
  layer7: '#c2ccd6', layer8: '#6b85a8',
};
const SHADE = '#0000008c';  // dark edge of lines, readable on bright and dark organs

/** Draws the marks of a view on a canvas of their own. @param which {force, scale, axes, section, inside} */
export function drawMarks(canvas, view, which) {
  const ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  const [w, h] = [Math.round(width * ratio), Math.round(height * ratio)];
  if (canvas.width !== w || canvas.height !== h) [canvas.width, canvas.height] = [w, h];
  const c = canvas.getContext('2d');
  c.setTransform(ratio, 0, 0, ratio, 0, 0);
  c.clearRect(0, 0, width, height);
  const {lines, triangles, words} = view.marks({width, height, letters: LETTERS, ...which});
  for (const {from, to, width: wide, colour} of lines) {
    for (const [style, more] of [[SHADE, 2], [COLOURS[colour], 0]]) {
      c.strokeStyle = style;
      c.lineWidth = wide + more;
      c.beginPath();
      c.moveTo(...from);
      c.lineTo(...to);
      c.stroke();
    }
  }
  for (const {corners, colour} of triangles) {
    c.fillStyle = COLOURS[colour];
    c.beginPath();
    for (const corner of corners) c.lineTo(...corner);
    c.fill();
    if (colour.startsWith('layer')) {  // no seams between neighbours
      c.strokeStyle = c.fillStyle;
      c.lineWidth = 0.7;
      c.stroke();
    }
  }
  c.font = `550 ${LETTERS}px system-ui, "Segoe UI", "DejaVu Sans", sans-serif`;
  c.textBaseline = 'top';
  c.lineWidth = 3;
  c.lineJoin = 'round';
  for (const {at, colour, text} of words) {
    c.strokeStyle = SHADE;
    c.strokeText(text, ...at);
    c.fillStyle = COLOURS[colour];
    c.fillText(text, ...at);
  }
}
