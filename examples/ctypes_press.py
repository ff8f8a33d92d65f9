#!/usr/bin/env python3
"""Presses the built-in gallbladder from Python through the C interface, with ctypes alone.

Usage: ctypes_press.py LIBPALPATE.so [SCENE.toml]
"""
import ctypes
import math
import sys
from ctypes import c_char_p, c_double, c_int32, c_size_t, c_uint32, c_uint64, c_void_p

ABI_VERSION = 0
PROGRESS = ctypes.CFUNCTYPE(None, c_double, c_char_p, c_void_p)


def struct(name, fields):
    """A struct of palpate.h, which begins with its size."""
    made = type(name, (ctypes.Structure,), {'_fields_': [('struct_size', c_size_t), *fields]})
    made.fresh = classmethod(lambda cls: cls(struct_size=ctypes.sizeof(cls)))
    return made


Options = struct('Options', [
    ('scene_file', c_char_p), ('scene_text', c_char_p), ('scene_folder', c_char_p), ('task', c_char_p),
    ('record_file', c_char_p), ('record_waits', c_int32), ('no_hand', c_int32), ('no_cache', c_int32),
    ('reserved', c_int32), ('surface_edge', c_double), ('progress', PROGRESS), ('progress_user', c_void_p)])
Info = struct('Info', [
    ('hands', c_uint32), ('held', c_uint32), ('rate', c_double), ('max_force', c_double), ('max_torque', c_double),
    ('seed', c_uint64), ('scripted_ticks', c_uint64), ('vertices', c_size_t), ('triangles', c_size_t),
    ('remarks', c_size_t), ('tool_parts', c_uint32 * 4)])
Sample = struct('Sample', [
    ('position', c_double * 3), ('orientation', c_double * 4), ('velocity', c_double * 3), ('gripper', c_double),
    ('age', c_double), ('buttons', c_uint32), ('fault', c_uint32)])
Result = struct('Result', [
    ('tick', c_uint64), ('time', c_double), ('device_force', c_double * 3), ('device_torque', c_double * 3),
    ('gripper_force', c_double), ('force', c_double * 3), ('torque', c_double * 3), ('tissue_force', c_double),
    ('noise_force', c_double), ('friction', c_double), ('distance', c_double), ('depth', c_double),
    ('contact', c_double * 3), ('normal', c_double * 3), ('tool_position', c_double * 3),
    ('tool_orientation', c_double * 4), ('gripper', c_double), ('energy', c_double), ('engagement', c_double),
    ('phase', c_uint32), ('cutoff_layer', c_uint32), ('saturated', c_uint32), ('status', c_uint32),
    ('fault', c_uint32), ('reserved', c_uint32)])


def load(path):
    """Loads the library and declares the types of the used functions."""
    library = ctypes.CDLL(path)
    library.palpate_version.restype = c_char_p
    library.palpate_last_error.restype = c_char_p
    library.palpate_name.restype = c_char_p
    library.palpate_name.argtypes = [c_void_p]
    library.palpate_scripted_sample.argtypes = [c_void_p, c_uint32, c_uint64, ctypes.POINTER(Sample)]
    library.palpate_tick.argtypes = [c_void_p, ctypes.POINTER(Sample), ctypes.POINTER(Result), c_size_t]
    library.palpate_get_info.argtypes = [c_void_p, ctypes.POINTER(Info)]
    library.palpate_close.argtypes = [c_void_p]
    if library.palpate_abi_version() != ABI_VERSION:
        sys.exit(f'libpalpate {library.palpate_version().decode()} is not the one this was written for')
    return library


def main():
    library = load(sys.argv[1])

    def check(status):
        if status != 0:
            sys.exit('ctypes_press: ' + library.palpate_last_error().decode())

    options, simulation, info = Options.fresh(), c_void_p(), Info.fresh()
    options.scene_file = sys.argv[2].encode() if len(sys.argv) > 2 else None
    options.no_hand = 1  # no hand: the samples come from a path
    check(library.palpate_open(ctypes.byref(options), ctypes.byref(simulation)))
    check(library.palpate_get_info(simulation, info))
    print(f'{library.palpate_name(simulation).decode()}: {info.hands} hand(s) at {info.rate:g} Hz')

    samples = (Sample * info.hands)(*(Sample.fresh() for _ in range(info.hands)))
    results = (Result * info.hands)(*(Result.fresh() for _ in range(info.hands)))
    deepest = largest_force = 0.0
    for tick in range(info.scripted_ticks):
        for hand in range(info.hands):
            check(library.palpate_scripted_sample(simulation, hand, tick, samples[hand]))
        check(library.palpate_tick(simulation, samples, results, info.hands))
        for result in results:
            x, y, z = result.force
            largest_force = max(largest_force, math.sqrt(x * x + y * y + z * z))
            deepest = max(deepest, result.depth)
    print(f'deepest {deepest!r} m, largest force {largest_force!r} N')
    check(library.palpate_close(simulation))


if __name__ == '__main__':
    main()
