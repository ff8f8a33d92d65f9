#!/usr/bin/env python3
"""Palpate as the stimulus server of your own experiment, as in PsychoPy: blind conditions, the server's clock, a log.

The script knows only codes: which of them has the noise is drawn into sealed.json, which the last command opens.
Usage: palpate serve --device haply &                                     # emulated without a device
       stimulus_server.py FOLDER [--port PORT] [--trials N] [--unblind]
It needs only Python's standard library. In PsychoPy replace answer() by event.waitKeys() and time by core.getTime().
"""
import argparse
import hashlib
import json
import os
import pathlib
import random
import time

from live_client import LiveClient

CONDITIONS = {'off': 0.0, 'noise': 1.0}  # standard deviation in contact, as a share of LEVEL_N
LEVEL_N = 0.012
FAR_MM = 1e6                             # K/(d + d0) is then the same at any distance
INTERVAL_S = 0.4


class Log:
    """Lines of JSON. Each holds the SHA-256 of the line before it, so that a changed or missing line is found."""

    def __init__(self, file):
        self.file = file
        self.last = self.check() if file.exists() else ''

    def check(self):
        before = ''
        for line in self.file.read_text().splitlines():
            if json.loads(line)['previous'] != before:
                raise SystemExit(f'{self.file}: was changed before: {line}')
            before = hashlib.sha256(line.encode()).hexdigest()
        return before

    def add(self, **values):
        line = json.dumps({'previous': self.last, **values})
        with self.file.open('a') as log:
            log.write(line + '\n')
            log.flush()
            os.fsync(log.fileno())
        self.last = hashlib.sha256(line.encode()).hexdigest()


class Stimuli:
    """Gives stimuli by their codes. The times are those of the run: time_s of its ticks."""

    def __init__(self, client, sealed):
        self.client = client
        if not sealed.exists():
            names = list(CONDITIONS)
            random.SystemRandom().shuffle(names)
            descriptor = os.open(sealed, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600)
            with os.fdopen(descriptor, 'w') as file:
                json.dump({f'c{i + 1}': name for i, name in enumerate(names)}, file)
        self._names = json.loads(sealed.read_text())
        self.codes = sorted(self._names)

    def clock(self):
        """Offset of the run's clock from time.monotonic(), and half the shortest round trip, which bounds its error [s]."""
        while self.client.ask('state')['state'] is None:  # the run has just begun
            time.sleep(0.02)
        best = None
        for _ in range(20):
            before = time.monotonic()
            run = self.client.ask('state')['state']['time_s']
            after = time.monotonic()
            if best is None or after - before < 2 * best[1]:
                best = run - (before + after) / 2, (after - before) / 2
            time.sleep(0.02)
        return best

    def give(self, code):
        """One interval. Returns time_s of the newest tick before the change, and of the first frame that has it."""
        share = CONDITIONS[self._names[code]]
        before = self.client.ask('state')['state']['time_s']
        # A condition without noise sends the same messages.
        change = self.client.ask('set_noise', noise={'enabled': share > 0.0, 'gain_N_m': LEVEL_N * FAR_MM * 1e-3,
                                                     'threshold_mm': FAR_MM})['change']
        while (state := self.client.ask('state')['state'])['change'] < change:
            time.sleep(0.002)
        fault = state['hands'][0]['fault']
        time.sleep(INTERVAL_S)
        self.client.ask('set_noise', noise={'enabled': False})
        return before, state['time_s'], fault


def answer(first, second):
    """Which interval tingled? Here nobody is asked."""
    return random.choice((1, 2))


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument('folder', type=pathlib.Path)
    parser.add_argument('--port', type=int, default=7370)
    parser.add_argument('--trials', type=int, default=4)
    parser.add_argument('--unblind', action='store_true', help='note it in the log, and print which code is which')
    flags = parser.parse_args()
    flags.folder.mkdir(exist_ok=True)
    log = Log(flags.folder / 'trials.jsonl')
    sealed = flags.folder / 'sealed.json'
    if flags.unblind:
        log.add(event='unblinded', time=time.time())
        print(sealed.read_text())
        return
    client = LiveClient(port=flags.port)
    stimuli = Stimuli(client, sealed)
    client.ask('set_noise', noise={'enabled': False})
    offset, error = stimuli.clock()
    log.add(event='session', time=time.time(), program=client.hello['program'], clock_offset_s=offset, clock_error_s=error)
    print(f'clock of the run: {1e3 * error:.1f} ms or better')
    for trial in range(flags.trials):
        codes = random.sample(stimuli.codes, 2)
        given = [stimuli.give(code) for code in codes]
        chosen = answer(*given)
        log.add(event='trial', trial=trial, codes=codes, onsets_s=[[before, seen] for before, seen, _ in given],
                faults=[fault for _, _, fault in given], answer=chosen, time=time.time())
    client.close()
    print(f'{flags.trials} trials in {log.file}')


if __name__ == '__main__':
    main()
