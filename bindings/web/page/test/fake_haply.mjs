// A stand-in for Haply's Inverse Service on 127.0.0.1: one state message at the start and one per command.
import {createHash} from 'node:crypto';
import {createServer} from 'node:http';

function frame(text) {
  const body = Buffer.from(text);
  const head = body.length < 126 ? Buffer.from([0x81, body.length]) : Buffer.from([0x81, 126, body.length >> 8, body.length & 255]);
  return Buffer.concat([head, body]);
}

/** Cuts masked frames of less than 64 KiB from the received bytes. @return {frames: [{opcode, text}], rest} */
function unframe(bytes) {
  const frames = [];
  for (;;) {
    if (bytes.length < 2) return {frames, rest: bytes};
    const long = (bytes[1] & 127) === 126, start = long ? 4 : 2;
    if (bytes.length < start) return {frames, rest: bytes};
    const length = long ? bytes.readUInt16BE(2) : bytes[1] & 127;
    if (bytes.length < start + 4 + length) return {frames, rest: bytes};
    const mask = bytes.subarray(start, start + 4), body = Buffer.from(bytes.subarray(start + 4, start + 4 + length));
    body.forEach((byte, i) => { body[i] = byte ^ mask[i % 4]; });
    frames.push({opcode: bytes[0] & 15, text: body.toString()});
    bytes = bytes.subarray(start + 4 + length);
  }
}

export class FakeHaply {
  position = [0, 0, 0];      // m, of the next states
  status = {power_supply: true, ready: true};
  forces = [];               // N, received
  silent = false;            // sends nothing
  text = null;               // sent in place of a state
  #sockets = new Set();

  async start(port = 0) {
    this.server = createServer((_, answer) => { answer.writeHead(404); answer.end(); });
    this.server.on('upgrade', (request, socket) => this.#talk(request, socket));
    await new Promise(ready => this.server.listen(port, '127.0.0.1', ready));
    this.port = this.server.address().port;
    return this;
  }
  get address() { return `ws://127.0.0.1:${this.port}`; }

  state() {
    const [x, y, z] = this.position;
    return this.text ?? JSON.stringify({inverse3: [{device_id: '04BA', status: this.status,
      state: {cursor_position: {x, y, z}, cursor_velocity: {x: 0, y: 0, z: 0}}}]});
  }

  /** Breaks all connections off. */
  drop() { for (const socket of this.#sockets) socket.destroy(); }
  async stop() {
    this.drop();
    await new Promise(done => this.server.close(done));
  }

  #talk(request, socket) {
    const key = createHash('sha1').update(`${request.headers['sec-websocket-key']}258EAFA5-E914-47DA-95CA-C5AB0DC85B11`);
    socket.setNoDelay(true);
    socket.write(`HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Accept: ${key.digest('base64')}\r\n\r\n`);
    this.#sockets.add(socket);
    socket.on('close', () => this.#sockets.delete(socket)).on('error', () => {});
    if (!this.silent) socket.write(frame(this.state()));
    let bytes = Buffer.alloc(0);
    socket.on('data', more => {
      const {frames, rest} = unframe(Buffer.concat([bytes, more]));
      bytes = rest;
      for (const {opcode, text} of frames) {
        if (opcode === 8) return socket.end();
        const {x, y, z} = JSON.parse(text).inverse3[0].commands.set_cursor_force.values;
        this.forces.push([x, y, z]);
        if (!this.silent) socket.write(frame(this.state()));
      }
    });
  }
}
