"""Scenes of tools/check_energy: about 600 chosen ones, one function a kind, and random ones that mix their ingredients."""
import dataclasses
import math
import random
import struct

import numpy as np

DEFAULT_LIMITS = {'max_force_N': 20.0, 'max_slew_N_per_ms': 5.0, 'max_torque_N_m': 0.2, 'max_slew_N_m_per_ms': 0.05}
LIGHT, FIRM, CLAMPED = (50.0, 1.0), (500.0, 5.0), (5000.0, 0.0)  # N/m, N s/m of a grip
ORGANS = ('gallbladder', 'liver', 'heart', 'kidney')
BOX_TOP = 20.0                  # mm
DEFAULT_SECONDS = 4.0           # of a scene without a path
NOISE_GAIN = 5e-5               # N m
SLOPE_OF_PRESETS = 1200.0       # N/m, the largest of a built-in tissue


@dataclasses.dataclass
class Case:
    name: str
    scene: dict
    tissue: object              # name of a built-in tissue, or the table of a tissue file
    files: dict                 # contents by file name
    changes: list               # of a live run: (tick, keys of the tissue or of an inclusion)
    stiffness: float            # N/m, K of the bound on a moving organ
    seconds: float
    kind: str = ''

    def limits(self):
        return {**DEFAULT_LIMITS, **self.scene.get('safety', {})}

    def motions(self):
        return self.scene['organ'].get('motion', [])

    def has_faults(self):
        return any('fault' in device for device in self.scene['device'])


def case(name, tissue, path=None, *, organ='box', tool='sphere:5', jaws=None, jaw_radius=5.0, inclusions=(), points=(), motion=(),
         device=None, faults=(), safety=None, rate=1000, hands=1, noise=False, task='press', changes=()):
    """A scene with this tissue. Without a path the hand follows the default one. jaws: as many balls at the same position."""
    files = {}
    body = {'mesh': organ, 'tissue': tissue if isinstance(tissue, str) else 'tissue.toml'}
    if inclusions:
        body['inclusion'] = list(inclusions)
    if points:
        body['stiffness'] = {'map': './map.csv'}
        files['map.csv'] = 'x_mm,y_mm,z_mm,factor\n' + ''.join(f'{x!r},{y!r},{z!r},{f!r}\n' for x, y, z, f in points)
    if motion:
        body['motion'] = list(motion)
    instrument = {'mesh': tool}
    if jaws:
        jaw = {'mesh': './ball.stl', 'pivot_mm': [0.0, 0.0, 0.0], 'axis': [0.0, 1.0, 0.0], 'open_deg': 0.0}
        instrument = {'unit': 'mm', 'jaw': [jaw] * jaws}
        files['ball.stl'] = ball(jaw_radius)
    emulated = {'kind': 'emulated', **(device or {})}
    if path is not None:
        emulated['path'] = './path.csv'
        files['path.csv'] = path
    if faults:
        emulated['fault'] = list(faults)
    scene = {'scene': {'name': name, 'rate_Hz': rate, 'task': task, 'seed': 1}, 'organ': body, 'tool': [instrument] * hands,
             'device': [emulated] * hands, 'noise': {'enabled': noise, 'gain_N_m': NOISE_GAIN if noise else 0.0}}
    if safety:
        scene['safety'] = safety
    return Case(name, scene, tissue, files, list(changes), stiffness_of(tissue, inclusions),
                seconds_of(path) if path else DEFAULT_SECONDS)


def wall(k, **contact):
    """A linear spring of k N/m, 30 mm deep, without friction."""
    return {'name': 'wall', 'law': 'layered', 'k1_N_per_m': float(k), 'beta': 10.0, 'q': 1.02, 'rest_length_mm': 50.0,
            'max_length_mm': 80.0, 'min_length_mm': 20.0, 't1_us': 100.0, 'contact': {'friction': 0.0, **contact}}


def layers(k=18.0, beta=1.6, rest=14.0, limit=8.0, q=0.7, **more):
    """A layered tissue; the gallbladder's numbers by default."""
    return {'name': 'layers', 'law': 'layered', 'k1_N_per_m': k, 'beta': beta, 'q': q, 'rest_length_mm': rest,
            'max_length_mm': rest + limit, 'min_length_mm': rest - limit, 't1_us': 1.0, **more}


def press(depth, *, radius=5.0, clear=4.0, hold=1.5, wave=(0.0, 3.0), side=(0.0, 2.0), x=0.0, scale=1.0, turn=None):
    """Path [mm] of a ball that rests over the box for 1 s, goes in, holds and comes back.

    wave, side: amplitude [mm] and frequency [Hz] of a motion along z and x while it holds."""
    t = np.arange(0.0, 2.1 + hold, 0.002)

    def rise(since, takes):
        u = np.clip((t - since) / takes, 0.0, 1.0)
        return u**3 * (10.0 - 15.0 * u + 6.0 * u**2)
    inside = rise(1.0, 0.6) - rise(1.6 + hold, 0.4)
    held = np.where((t > 1.6) & (t < 1.6 + hold), t - 1.6, 0.0)
    z = BOX_TOP + radius + clear - (clear + depth) * inside + wave[0] * np.sin(2.0 * np.pi * wave[1] * held)
    along = x + side[0] * np.sin(2.0 * np.pi * side[1] * held)
    rows = np.stack([t, along / scale * 1e-3, np.zeros_like(t), z / scale * 1e-3], 1)
    more = ',qw,qx,qy,qz' if turn else ''
    rows = np.hstack([rows, np.tile(turn, (len(rows), 1))]) if turn else rows
    return f'time_s,x_m,y_m,z_m{more}\n' + '\n'.join(','.join(map(repr, row)) for row in rows.tolist()) + '\n'


def stiffness_of(tissue, inclusions):
    """The largest tangent stiffness [N/m] of three layers above the stiffest inclusion."""
    largest = max([1.0] + [inclusion['stiffness_ratio'] for inclusion in inclusions])
    if isinstance(tissue, str):
        return SLOPE_OF_PRESETS * largest
    third = 16.0 * math.exp(min(2.0 / tissue['beta'], 100.0)) if tissue['name'] == 'layers' else 1.0
    return tissue['k1_N_per_m'] * third * largest


def seconds_of(path):
    return float(path.rstrip().rsplit('\n', 1)[1].split(',')[0])


def ball(radius, n=12):
    """A binary STL file of a ball."""
    def corner(i, j):
        a, b = math.pi * i / n, math.pi * (j % (2 * n)) / n
        return radius * math.sin(a) * math.cos(b), radius * math.sin(a) * math.sin(b), radius * math.cos(a)
    triangles = []
    for i in range(n):
        for j in range(2 * n):
            if i > 0:
                triangles.append((corner(i, j), corner(i + 1, j), corner(i, j + 1)))
            if i < n - 1:
                triangles.append((corner(i, j + 1), corner(i + 1, j), corner(i + 1, j + 1)))
    return b'\0' * 80 + struct.pack('<I', len(triangles)) + b''.join(
        struct.pack('<12fH', 0, 0, 0, *a, *b, *c, 0) for a, b, c in triangles)


def stone(x=0.0, y=0.0, radius=5.0, z=None, ratio=100.0, **more):
    """An inclusion that almost touches the box's top [mm]."""
    height = BOX_TOP - radius - 0.1 if z is None else z
    return {'position_mm': [x, y, height], 'radius_mm': radius, 'stiffness_ratio': ratio, **more}


def hand(damping=1.5, friction=0.0, resolution=0.0, mass=0.25, grip=FIRM):
    return {'damping_N_s_per_m': damping, 'friction_N': friction, 'resolution_mm': resolution, 'mass_kg': mass,
            'grip_N_per_m': grip[0], 'grip_N_s_per_m': grip[1]}


def breathing(amplitude, period, **more):
    return {'kind': 'breathing', 'amplitude_mm': amplitude, 'period_s': period, **more}


TAP = press(8.0, wave=(2.0, 3.0))
GLIDE = press(6.0, side=(12.0, 2.0))
EDGE = press(10.0, side=(3.0, 1.0))
DEEP = press(12.0)


# ---- Kinds of scenes: each function yields the chosen scenes of a kind

def walls():
    """Stiff walls by rate, damping, mass and grip."""
    def deep_enough(k, grip):
        return min(12.0, 3e3 / k + 4e3 / grip[0])
    for rate in (1000, 4000, 10000):
        for damping in (1.5, 8.0, 20.0):
            k = min(0.8 * 2.0 * (damping - 0.05) * rate, 9e4)
            for mass, grip in ((0.05, LIGHT), (0.25, FIRM), (0.05, CLAMPED)):
                wave = (min(2.0, 2e3 / k + 1e3 / grip[0]), 4.0)
                yield case(f'edge-{rate}-{damping:g}-{mass:g}-{grip[0]:g}', wall(k, damping_N_s_per_m=0.0),
                           press(deep_enough(k, grip), wave=wave), rate=rate, device=hand(damping, mass=mass, grip=grip))
    for damping in (3.0, 5.0, 8.0, 12.0, 20.0):
        for share in (0.3, 0.5, 0.7, 0.9):
            k = min(share * 2.0 * (damping - 0.05) * 1000.0, 9e4)
            for mass, grip in ((0.25, FIRM), (0.05, LIGHT)):
                yield case(f'share-{damping:g}-{share}-{mass:g}-{grip[0]:g}', wall(k, damping_N_s_per_m=0.0),
                           press(deep_enough(k, grip)), device=hand(damping, mass=mass, grip=grip))
    for k in (10, 100, 300, 900, 1400, 1900, 3000, 1e4, 1e6, 1e9):
        for name, path in (('tap', TAP), ('glide', GLIDE)):
            yield case(f'{name}-{k:g}', wall(k), path)


def light_hands():
    """Walls within the condition of the stability check, held by a light mass."""
    for k, damping, friction, resolution in ((12720, 8.0, 0.0, 0.0), (12720, 8.0, 0.1, 0.01), (35900, 20.0, 0.0, 0.0),
                                             (30000, 20.0, 0.2, 0.01)):
        for mass in (0.05, 0.1, 1.0):
            for word, grip in (('light', LIGHT), ('firm', FIRM)):
                yield case(f'light-{k}-{friction:g}-{mass:g}-{word}', wall(k, damping_N_s_per_m=0.0), DEEP,
                           device=hand(damping, friction, resolution, mass, grip))


def curved():
    """Stiff walls on curved organs."""
    for organ in ORGANS:
        for rate, damping, k in ((1000, 1.5, 1900), (1000, 8.0, 4000), (1000, 8.0, 8000), (4000, 1.5, 8000), (10000, 8.0, 17000)):
            for word, grip in (('light', LIGHT), ('firm', FIRM)):
                yield case(f'{organ}-{rate}-{damping:g}-{k}-{word}', wall(k, damping_N_s_per_m=0.0), organ=organ, rate=rate,
                           device=hand(damping, 0.2, 0.01, grip=grip))
    for organ in ('liver', 'box', 'kidney'):
        for k, mass, damping in ((17600, 0.11, 20.0), (17600, 0.05, 20.0), (8000, 0.05, 8.0), (4000, 0.05, 8.0)):
            yield case(f'{organ}-10000-{k}-{mass:g}', wall(k, damping_N_s_per_m=0.0), organ=organ, rate=10000,
                       device=hand(damping, 0.1, 0.01, mass, LIGHT))


def overlapping():
    """Stones at the same position, whose factors multiply."""
    for k in (30, 100, 300, 900):
        for n in (1, 2, 3, 4, 5, 6, 8):
            yield case(f'overlap-{k}-{n}', wall(k), TAP, inclusions=[stone()] * n)
    for k in (300, 900):
        for n in (2, 8):
            for radius in (0.5, 2.0, 5.0):
                yield case(f'overlap-glide-{k}-{n}-{radius:g}', wall(k), GLIDE, inclusions=[stone(radius=radius)] * n)
    for tissue in ORGANS:
        for n in (2, 4, 8):
            yield case(f'overlap-{tissue}-{n}', tissue, TAP, inclusions=[stone()] * n)
        yield case(f'cysts-{tissue}-8', tissue, TAP, inclusions=[stone(ratio=0.1)] * 8)


def neighbours():
    """Inclusions that touch, or lie side by side."""
    ring = [(2.0 * math.cos(i * math.pi / 3.5), 2.0 * math.sin(i * math.pi / 3.5)) for i in range(7)]
    for k in (100, 300, 900):
        four = [stone(x, y, 2.0) for x in (-2.0, 2.0) for y in (-2.0, 2.0)]
        yield case(f'touch-{k}-4', wall(k), TAP, inclusions=four)
        yield case(f'touch-glide-{k}-4', wall(k), GLIDE, inclusions=four)
        yield case(f'touch-{k}-8', wall(k), TAP, inclusions=[stone(x, y, 1.0) for x, y in ring + [(0.0, 0.0)]])
        yield case(f'row-{k}-8', wall(k), GLIDE, inclusions=[stone(3.0 * i - 10.5, 0.0, 1.4) for i in range(8)])
        yield case(f'mixed-{k}-8', wall(k), GLIDE, inclusions=[stone(3.0 * i - 10.5, 0.0, 1.4, ratio=(100.0, 0.1)[i % 2])
                                                               for i in range(8)])


def small_tips():
    """Tips smaller and larger than the stones under them."""
    path = press(6.0, radius=0.5, side=(8.0, 2.0))
    for k in (300, 900):
        tip = {'tool': 'sphere:0.5'}
        yield case(f'tip-{k}-1', wall(k), path, inclusions=[stone(radius=0.5)], **tip)
        yield case(f'tip-{k}-row', wall(k), path, inclusions=[stone(i - 4.0, radius=0.5) for i in range(8)], **tip)
        yield case(f'tip-{k}-8', wall(k), path, inclusions=[stone(radius=0.5)] * 8, **tip)
    for radius in (0.7, 1.5, 3.0, 10.0, 20.0):
        for stones in (0.5, 5.0):
            yield case(f'tip-{radius:g}-{stones:g}', wall(300), press(8.0, radius=radius, wave=(1.0, 3.0)),
                       tool=f'sphere:{radius:g}', inclusions=[stone(radius=stones)])


def maps():
    """Stiffness maps: combs, stripes and peaks, which push a hand sideways."""
    for step in (0.5, 1.0, 2.0, 4.0, 8.0):
        comb = [(x, float(y), BOX_TOP, (1.0, 0.01)[i % 2]) for i, x in enumerate(np.arange(-16.0, 16.1, step).tolist())
                for y in range(-12, 13, 4)]
        for k in (300, 900):
            yield case(f'comb-{step:g}-{k}', wall(k), GLIDE, points=comb)
    for high in (1.0, 10.0, 100.0):
        for around in (1.0, 3.0):
            ring = [(around * math.cos(i * math.pi / 6), around * math.sin(i * math.pi / 6)) for i in range(12)]
            peak = [(0.0, 0.0, BOX_TOP, high)] + [(x, y, BOX_TOP, 0.01) for x, y in ring]
            for k in (30, 100, 300, 500, 900):
                if k * high <= 1900.0:
                    yield case(f'peak-{high:g}-{around:g}-{k}', wall(k), EDGE, points=peak)
            if high == 1.0:
                for tissue in ORGANS:
                    yield case(f'peak-{around:g}-{tissue}', tissue, EDGE, points=peak)


def layer_jumps():
    """Layered laws whose second layer is much stiffer, or very thin."""
    for beta in (0.01, 0.02, 0.025, 0.03, 0.1, 0.3, 0.6, 4.0):
        yield case(f'beta-{beta:g}', layers(beta=beta), TAP)
        yield case(f'beta-{beta:g}-short', layers(beta=beta, rest=1.0, limit=0.5), TAP)
    for limit in (0.001, 0.5, 2.0):
        for q in (0.1, 0.7, 1.5):
            yield case(f'limit-{limit:g}-{q:g}', layers(beta=2.0, rest=14.0, limit=limit, q=q), TAP)
    for k in (18.0, 100.0, 900.0):
        yield case(f'smooth-{k:g}', {**layers(k), 'law': 'smooth'}, TAP)


def contact_damping():
    """Contact damping up to nearly the device's."""
    path = press(8.0, wave=(2.0, 6.0), side=(4.0, 3.0))
    for damping in (1.5, 8.0, 20.0):
        for share in (0.5, 0.9):
            k = 0.2 * (1.0 - share) * 2.0 * damping * 1000.0
            b = share * damping * 0.95
            tissue = wall(k, damping_N_s_per_m=b, tangential_damping_N_s_per_m=b, friction=1.0, tangential_N_per_m=k)
            for mass in (0.05, 0.25):
                for word, friction, resolution in (('exact', 0.0, 0.0), ('real', 0.2, 0.01)):
                    yield case(f'damping-{damping:g}-{share}-{mass:g}-{word}', tissue, path,
                               device=hand(damping, friction, resolution, mass))


def friction_springs():
    """Friction springs as stiff as the wall, or stiffer."""
    for k in (100, 500, 900):
        for friction in (0.2, 10.0):
            for times in (1.0, 3.0):
                tissue = wall(k, friction=friction, tangential_N_per_m=times * k)
                yield case(f'friction-{k}-{friction:g}-{times:g}', tissue, GLIDE)


def limits():
    """Small limits of force, torque and slew, which act after the passivity controller."""
    for tissue in ORGANS:
        for slew in (0.001, 0.002, 0.005, 0.01):
            yield case(f'slew-{tissue}-{slew:g}', tissue, press(12.0, wave=(2.0, 3.0)), safety={'max_slew_N_per_ms': slew})
    for k in (300, 900, 1900):
        for slew in (0.001, 0.01, 0.02, 0.05, 0.2, 5.0):
            yield case(f'slew-{k}-{slew:g}', wall(k), TAP, safety={'max_slew_N_per_ms': slew})
    for k in (300, 900):
        for force in (0.05, 0.5, 2.0, 50.0):
            yield case(f'force-{k}-{force:g}', wall(k), TAP, safety={'max_force_N': force})
    yield case('torque', wall(900), GLIDE, tool='curved-forceps',
               safety={'max_torque_N_m': 1e-6, 'max_slew_N_m_per_ms': 1e-6})


def moving():
    """Organs that breathe or beat against a hand."""
    for damping, k in ((1.5, 2000), (8.0, 10000), (20.0, 25000)):
        for resolution in (0.0, 0.001, 0.01):
            for amplitude, period in ((10.0, 4.0), (50.0, 1.0)):
                yield case(f'breath-{k}-{resolution:g}-{amplitude:g}', wall(k, damping_N_s_per_m=0.0),
                           press(0.0, clear=6.0 + amplitude, hold=4.0), motion=[breathing(amplitude, period)],
                           device=hand(damping, 0.3, resolution))
    for word, motion in (('breath', breathing(20.0, 1.3)), ('beat', {'kind': 'heartbeat', 'amplitude_mm': 5.0, 'period_s': 0.6})):
        for organ in ORGANS:
            for k, damping, mass in ((900, 1.5, 0.25), (5000, 8.0, 0.07), (24600, 20.0, 0.07)):
                yield case(f'{word}-{organ}-{k}', wall(k, damping_N_s_per_m=0.0), organ=organ, motion=[motion], tool='sphere:2',
                           device=hand(damping, 0.3, 0.001, mass), hands=2 if k == 24600 else 1)
            yield case(f'{word}-{organ}-own', organ, organ=organ, motion=[motion])
    for k in (300, 900):
        yield case(f'turning-{k}', wall(k), GLIDE, motion=[breathing(5.0, 1.0, rotation_deg=20.0, axis=[0, 1, 0])])
        yield case(f'moving-stones-{k}', wall(k), TAP, motion=[breathing(10.0, 1.0)], inclusions=[stone()] * 3)


def many_contacts():
    """Parts of a tool at the same position, and contacts that share no load because each represents a small area."""
    for count in (2, 3):
        for radius in (1.0, 10.0):
            for k in (500, 900, 1400, 1900):
                yield case(f'jaws-{count}-{radius:g}-{k}', wall(k, reference_radius_mm=radius), TAP, jaws=count)
    for radius in (0.01, 1.0, 3.0):  # 1e-2 mm may be refused
        for k in (300, 900, 1900):
            yield case(f'reference-{radius:g}-{k}', wall(k, reference_radius_mm=radius), TAP)
    for radius in (1.0, 3.0, 10.0):
        yield case(f'forceps-{radius:g}', wall(900, reference_radius_mm=radius), TAP, tool='curved-forceps')
        yield case(f'forceps-stone-{radius:g}', wall(300, reference_radius_mm=radius), press(10.0, radius=0.0),
                   tool='curved-forceps', inclusions=[stone(radius=2.0)])


def several_hands():
    """Hands that press the same point."""
    for n in (2, 4):
        for k in (300, 900, 1900):
            yield case(f'hands-{n}-{k}', wall(k), TAP, hands=n)
        yield case(f'hands-{n}-liver', 'liver', organ='liver', hands=n)


def workspaces():
    """A scale between device and world, which multiplies the stiffness at the hand."""
    for scale in (0.01, 0.1, 0.5, 2.0, 5.0, 100.0):
        for k in (300, 900):
            yield case(f'scale-{scale:g}-{k}', wall(min(k / scale, 1e5)), press(6.0, wave=(1.0, 3.0), scale=scale),
                       device={'workspace_scale': scale})


def relaxing():
    """Tissues that relax, slowly or within a few ticks."""
    for k in (300, 900, 1900):
        for share in (0.3, 0.9):
            for seconds in (0.005, 1.5):
                tissue = {**wall(k), 'relaxation': [{'share': share, 'time_s': seconds}]}
                yield case(f'relax-{k}-{share:g}-{seconds:g}', tissue, TAP)


def pulses():
    """Vessels that rise with each heartbeat."""
    for k in (100, 300, 900):
        for period in (0.2, 1.0):
            for rise in (1.0, 9.0):
                yield case(f'pulse-{k}-{period:g}-{rise:g}', wall(k), TAP, inclusions=[
                    stone(radius=3.0, z=BOX_TOP - 3.1 - rise, ratio=30.0, pulse_mm=rise, pulse_period_s=period)])


def faults():
    """Faults of the device while it is pressed."""
    for kind in ('freeze', 'late', 'drop-out', 'nan', 'spike', 'wrong-units', 'force-off', 'refuse'):
        for k in (300, 900):
            yield case(f'fault-{kind}-{k}', wall(k), TAP, faults=[{'kind': kind, 'time_s': t, 'duration_s': 0.02}
                                                                 for t in (1.7, 2.0, 2.3)])


def pulls():
    """Jaws that pull on tissue, and touch noise."""
    for organ in ORGANS:
        yield case(f'pull-{organ}', organ, organ=organ, task='pull', tool='curved-forceps')
        yield case(f'press-{organ}', organ, organ=organ)
        yield case(f'noise-{organ}', organ, organ=organ, noise=True)


def needles():
    """Needles that go in and out of layers, with reversals and sideways motion; the last ones in stiff channels."""
    path = press(34.0, radius=90.0, hold=2.0, wave=(8.0, 2.0), side=(2.0, 1.0), turn=(0.0, 1.0, 0.0, 0.0))
    more = {'task': 'insert', 'tool': 'needle'}
    for tissue in ('skin-fat-muscle', 'liver-capsule', 'vein', 'epidural'):
        for word, grip in (('light', LIGHT), ('firm', FIRM), ('clamped', CLAMPED)):
            for resolution in (0.0, 0.01):
                yield case(f'needle-{tissue}-{word}-{resolution:g}', tissue, path, device=hand(4.0, 0.1, resolution, grip=grip), **more)
        yield case(f'needle-{tissue}-4000', tissue, path, rate=4000, device=hand(), **more)
        yield case(f'needle-{tissue}-breath', tissue, path, motion=[breathing(8.0, 1.5, rotation_deg=5.0, axis=[0, 1, 0])],
                   device=hand(4.0), **more)
        yield case(f'needle-{tissue}-two', tissue, path, hands=2, device=hand(4.0), **more)
    layer = {'name': 'one', 'puncture_force_N': 2.0, 'cutting_force_N': 0.5, 'friction_N': 0.1, 'friction_N_per_mm': 0.02}
    for lateral in (0.01, 0.1, 1.0):  # the channel is up to 34 mm long: 340 N/m to 34 kN/m
        for damping in (1.5, 8.0):
            yield case(f'needle-channel-{lateral:g}-{damping:g}', {**layers(100.0), 'layer': [{**layer, 'lateral_N_per_mm2': lateral}]},
                       path, device=hand(damping, 0.1, 0.01), **more)


def live():
    """Parameters that change in step with the hand."""
    apart = [stone(x, y, 3.0, z=16.9, ratio=1.0) for x in (-8.0, 0.0, 8.0) for y in (-5.0, 5.0)]
    for k in (30, 100):
        together = [(1200 + i, {'inclusion': i, 'position': (0.0, 0.0, 0.0169), 'stiffness_ratio': 100.0}) for i in range(6)]
        yield case(f'live-together-{k}', wall(k), TAP, inclusions=apart, changes=together)
    for high, low in ((45.0, 5.0), (900.0, 90.0)):
        for phase in (0, 12, 25, 37):  # ticks: the hand lags behind its path
            yield case(f'live-pump-{high:g}-{phase}', wall(high), press(8.0, wave=(4.0, 10.0)), changes=[
                (1600 + phase + 50 * i, {'k1': (high, low)[i % 2]}) for i in range(29)])
    for beta in (0.02, 0.1):
        yield case(f'live-beta-{beta:g}', layers(), TAP, changes=[(1500, {'beta': beta})])
    yield case('live-stiff', wall(100), TAP, changes=[(1500, {'k1': 1e5})])


KINDS = (walls, light_hands, curved, overlapping, neighbours, small_tips, maps, layer_jumps, contact_damping, friction_springs,
         limits, moving, many_contacts, several_hands, workspaces, relaxing, pulses, faults, pulls, needles, live)

# For a short check: scenes of each kind that give energy without controller, check and guard, and scenes that are fine.
QUICK = ('overlap-100-3', 'overlap-100-6', 'peak-1-3-900', 'comb-1-900', 'beta-0.02', 'touch-100-4', 'slew-900-0.01',
         'light-12720-0-0.05-light', 'light-35900-0-0.1-firm', 'liver-10000-17600-0.05', 'slew-gallbladder-0.001',
         'slew-1900-0.02', 'breath-25000-0-10', 'breath-kidney-24600', 'jaws-3-1-1900', 'reference-1-1900',
         'live-together-100', 'live-beta-0.02', 'press-liver', 'noise-heart', 'pull-heart', 'tap-100', 'glide-300', 'needle-epidural-breath',
         'friction-500-0.2-1', 'breath-liver-own', 'hands-2-liver', 'relax-900-0.9-1.5', 'pulse-300-1-9',
         'fault-drop-out-300', 'damping-8-0.5-0.25-real')


def chosen():
    """All chosen scenes."""
    for kind in KINDS:
        for one in kind():
            one.kind = kind.__name__
            yield one


def random_case(seed, i):
    """Scene i of this seed, with ingredients of all kinds. Every second one has a moving organ."""
    rng = random.Random(f'{seed}/{i}')
    rate = rng.choice((1000, 1000, 1000, 2000, 4000, 10000))
    device = hand(rng.choice((1.5, 1.5, 3.0, 8.0, 20.0)), rng.choice((0.0, 0.05, 0.2, 1.0)), rng.choice((0.0, 0.001, 0.01)),
                  round(math.exp(rng.uniform(math.log(0.05), 0.0)), 3), rng.choice((LIGHT, FIRM, FIRM, CLAMPED)))
    tissue = random_tissue(rng, rate, device['damping_N_s_per_m'])
    organ = rng.choice(('box', 'box') + ORGANS)
    radius = rng.choice((0.5, 2.0, 5.0, 5.0, 10.0))
    more = {'tool': f'sphere:{radius:g}', 'hands': rng.choice((1, 1, 1, 2)), 'noise': rng.random() < 0.2, 'rate': rate,
            'organ': organ, 'device': device}
    if i % 2:
        more['motion'] = [random_motion(rng) for _ in range(rng.choice((1, 1, 2)))]
    if rng.random() < 0.5:
        more['inclusions'] = random_inclusions(rng, organ == 'box')
    if organ == 'box' and rng.random() < 0.2:
        more['points'] = [(2.0 * x, 3.0 * y, BOX_TOP, math.exp(rng.uniform(math.log(0.01), 0.0))) for x in range(-8, 9)
                          for y in range(-4, 5)]
    if rng.random() < 0.2:
        more['safety'] = {'max_slew_N_per_ms': rng.choice((0.001, 0.01, 0.05, 0.5, 50.0)),
                          'max_force_N': rng.choice((0.5, 2.0, 20.0, 50.0))}
    if rng.random() < 0.1 and radius == 5.0:
        more['jaws'] = rng.choice((2, 3))
    path = None if organ != 'box' else press(
        rng.uniform(2.0, 12.0), radius=radius, wave=(rng.choice((0.0, 1.0, 3.0)), rng.uniform(1.0, 10.0)),
        side=(rng.choice((0.0, 3.0, 10.0)), rng.uniform(0.5, 4.0)))
    one = case(f'random-{i}', tissue, path, **more)
    one.kind = 'random_moving' if i % 2 else 'random_still'
    return one


def random_tissue(rng, rate, damping):
    """A built-in tissue, a wall below the condition of the stability check, or layers."""
    kind = rng.choice(('preset', 'wall', 'wall', 'layers'))
    if kind == 'preset':
        return rng.choice(ORGANS)
    b = rng.choice((0.0, 0.0, 0.3, 0.9)) * damping
    k = min(math.exp(rng.uniform(math.log(0.01), 0.0)) * 2.0 * max(damping - b, 0.05) * rate, 5e4)
    friction = rng.choice((0.0, 0.2, 1.0, 3.0))
    contact = {'damping_N_s_per_m': b, 'friction': friction, 'tangential_N_per_m': k,
               'tangential_damping_N_s_per_m': rng.choice((0.0, b)), 'reference_radius_mm': rng.choice((10.0, 10.0, 1.0))}
    tissue = wall(k, **contact)
    if kind == 'layers':
        beta = math.exp(rng.uniform(math.log(0.03), math.log(5.0)))
        tissue = layers(k / 4.0, beta, limit=rng.uniform(1.0, 10.0), contact=contact)
    if rng.random() < 0.2:
        tissue['relaxation'] = [{'share': rng.choice((0.3, 0.8)), 'time_s': rng.choice((0.01, 0.1, 1.5))}]
    return tissue


def random_motion(rng):
    kind = rng.choice(('breathing', 'heartbeat'))
    period = rng.uniform(0.5, 5.0)
    return {'kind': kind, 'amplitude_mm': rng.uniform(1.0, min(25.0, 25.0 * period)), 'period_s': period,
            'rotation_deg': rng.choice((0.0, 0.0, 4.0, 10.0)), 'axis': [0, 1, 0]}


def random_inclusions(rng, on_box):
    """Inclusions in the box, often at the same position; in another organ below the point that the default path touches."""
    found, together = [], rng.random() < 0.5
    x, y = rng.uniform(-4.0, 4.0), rng.uniform(-4.0, 4.0)
    for _ in range(rng.randint(1, 8)):
        radius, ratio = rng.uniform(0.5, 5.0), math.exp(rng.uniform(math.log(0.1), math.log(100.0)))
        deep = radius + rng.uniform(0.1, 3.0)
        if not together:
            x, y = rng.uniform(-8.0, 8.0), rng.uniform(-6.0, 6.0)
        found.append(stone(x, y, radius, BOX_TOP - deep, ratio) if on_box else
                     {'depth_mm': deep, 'radius_mm': radius, 'stiffness_ratio': ratio})
    return found
