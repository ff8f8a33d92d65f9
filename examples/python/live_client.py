#!/usr/bin/env python3
"""Observes and controls a run of `palpate serve` through the live interface (docs/live-interface.md).

It needs only Python's standard library: the class LiveClient implements the WebSocket protocol (RFC 6455).
Usage: live_client.py [--host HOST] [--port PORT] [--token TOKEN] [--seconds S]
It streams for S seconds, doubles the stiffness of the tissue half-way, and prints the frames.
"""
import argparse
import base64
import json
import os
import socket
import struct


class LiveClient:
    """A connection to `palpate serve`. Raises an error of the server as RuntimeError."""

    def __init__(self, host='127.0.0.1', port=7370, token=None, timeout_s=30.0):
        self.socket = socket.create_connection((host, port), timeout_s)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self.waiting = b''
        self.last_id = 0
        self.events = []  # events and frames received while waiting for an answer
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f'GET / HTTP/1.1\r\nHost: {host}:{port}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n'
                             f'Sec-WebSocket-Key: {key}\r\nSec-WebSocket-Version: 13\r\n\r\n').encode())
        head = b''
        while not head.endswith(b'\r\n\r\n'):
            head += self._take(1)
        if b' 101 ' not in head.split(b'\r\n')[0]:
            raise RuntimeError('the server declines: ' + head.split(b'\r\n')[0].decode())
        hello = {'palpate': '1'}
        if token:
            hello['token'] = token
        self.hello = self.ask('hello', **hello)

    def ask(self, command, **fields):
        """Sends a command and returns its answer."""
        self.last_id += 1
        self._send(1, json.dumps({'do': command, 'id': self.last_id, **fields}).encode())
        while True:
            message = self._hear()
            if 'answer' not in message and 'error' not in message:
                self.events.append(message)
            elif message.get('id') == self.last_id or 'id' not in message:
                if 'error' in message:
                    raise RuntimeError(message['error']['words'])
                return message

    def next(self):
        """The next frame or event of the stream."""
        return self.events.pop(0) if self.events else self._hear()

    def close(self):
        self._send(8, struct.pack('!H', 1000))
        self.socket.close()

    def _take(self, count):
        while len(self.waiting) < count:
            more = self.socket.recv(65536)
            if not more:
                raise ConnectionError('the server has closed the connection')
            self.waiting += more
        taken, self.waiting = self.waiting[:count], self.waiting[count:]
        return taken

    def _send(self, kind, payload):
        """Sends one WebSocket frame, masked as clients must."""
        size = len(payload)
        head = struct.pack('!BB', 0x80 | kind, 0x80 | (size if size < 126 else 126))
        if size >= 126:
            head += struct.pack('!H', size)
        mask = os.urandom(4)
        self.socket.sendall(head + mask + bytes(byte ^ mask[i % 4] for i, byte in enumerate(payload)))

    def _hear(self):
        """The next message. Answers pings."""
        text = b''
        while True:
            first, size = self._take(2)
            if size == 126:
                size, = struct.unpack('!H', self._take(2))
            elif size == 127:
                size, = struct.unpack('!Q', self._take(8))
            payload = self._take(size)
            kind = first & 15
            if kind == 8:
                raise ConnectionError('the server ends the connection: ' + payload[2:].decode())
            if kind == 9:
                self._send(10, payload)
            elif kind in (0, 1):
                text += payload
                if first & 0x80:
                    return json.loads(text)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('--host', default='127.0.0.1')
    parser.add_argument('--port', type=int, default=7370)
    parser.add_argument('--token')
    parser.add_argument('--seconds', type=float, default=4.0)
    flags = parser.parse_args()

    client = LiveClient(flags.host, flags.port, flags.token)
    if client.ask('state')['run']['state'] != 'running':
        client.ask('start')
    about = client.ask('scene')
    stiffness = about['tissue']['k1_N_per_m']
    print(f"{client.hello['program']}: {about['scene']['name']}, tissue {about['tissue']['name']}, k1 {stiffness} N/m")
    client.ask('stream', rate_Hz=20)
    changed = False
    frames = 0
    begun = None
    while True:
        message = client.next()
        if message.get('event') == 'fault':
            print('fault:', message['fault']['words'])
        if message.get('event') == 'run' and message['run']['state'] == 'ended':
            print('the run has ended after', message['run'].get('ticks'), 'ticks')
            break
        if 'state' not in message:
            continue
        state = message['state']
        hand = state['hands'][0]
        begun = state['time_s'] if begun is None else begun
        frames += 1
        if frames % 10 == 1 or hand['fault'] != 'none':
            print(f"{state['time_s']:7.3f} s  {hand['phase']:8s}  depth {1e3 * hand['depth_m']:6.2f} mm"
                  f"  force {hand['force_N'][2]:7.4f} N  change {state['change']}")
        if not changed and state['time_s'] - begun > flags.seconds / 2:
            changed = True
            answer = client.ask('set_tissue', tissue={'k1_N_per_m': 2 * stiffness})
            print(f"twice as stiff, by change {answer['change']}")
        if state['time_s'] - begun > flags.seconds:
            break
    client.close()


if __name__ == '__main__':
    main()
