"""Golden frames of the adapters: `python3 generate.py` in this folder.

Written from the public sources that the adapters name and from nothing of the adapters: the structures are packed by `struct` as C aligns them, legs and
joints are dictionaries by name. The command is the one of `tests/adapters.rs`.
"""

import math
import struct
from functools import reduce

LEGS = ["FL", "FR", "RL", "RR"]  # this project's order
THEIRS = ["FR", "FL", "RR", "RL"]
JOINTS = ["hip", "thigh", "calf"]

command = {}
for i, (leg, joint) in enumerate((leg, joint) for leg in LEGS for joint in JOINTS):
    command[leg, joint] = dict(q=0.25 * i - 1.0, dq=2.0 - 0.5 * i, tau=3.0 * i, kp=20.0 + i, kd=1.0 + 0.125 * i)


def unitree_crc(words):
    """crc32_core of motor_crc.cpp: word by word from the highest bit."""
    crc = 0xFFFFFFFF
    for word in words:
        for bit in range(31, -1, -1):
            top = crc >> 31
            crc = (crc << 1) & 0xFFFFFFFF
            if top:
                crc ^= 0x04C11DB7
            if word >> bit & 1:
                crc ^= 0x04C11DB7
    return crc


def go2():
    motors = [command[leg, joint] for leg in THEIRS for joint in JOINTS]
    motors += [dict(q=2.146e9, dq=16000.0, tau=0.0, kp=0.0, kd=0.0)] * 8
    values, layout = [0xFE, 0xEF, 0xFF, 0, 0, 0, 0, 0, 0], "@2BBB2I2IH"
    for m in motors:
        # A structure begins where its widest member may: `0f` aligns.
        layout += "0fB5f3I"
        values += [1, m["q"], m["dq"], m["tau"], m["kp"], m["kd"], 0, 0, 0]
    layout += "B3B40B12B2BBI"
    values += [0] * (1 + 3 + 40 + 12 + 2 + 1 + 1)
    image = struct.pack(layout, *values)
    crc = unitree_crc(struct.unpack(f"<{len(image) // 4}I", image))
    return image + struct.pack("<I", crc)


def cheetah(board):
    abad_sign = [-1, -1, 1, 1]
    hip_sign = [-1, 1, -1, 1]
    knee_sign = [-0.6429, 0.6429, -0.6429, 0.6429]
    hip_offset = [math.pi / 2, -math.pi / 2, -math.pi / 2, math.pi / 2]
    knee_offset = [4.35, -4.35, -4.35, 4.35]
    numbers = []
    legs = [2 * board, 2 * board + 1]
    # Hip and knee of the published software bring the foot forward.
    at = lambda leg, joint, key: (1 if joint == "hip" else -1) * command[THEIRS[leg], joint][key]
    gain = lambda leg, joint, key: command[THEIRS[leg], joint][key]
    numbers += [at(i, "hip", "q") * abad_sign[i] for i in legs]
    numbers += [at(i, "thigh", "q") * hip_sign[i] + hip_offset[i] for i in legs]
    numbers += [at(i, "calf", "q") / knee_sign[i] + knee_offset[i] for i in legs]
    numbers += [at(i, "hip", "dq") * abad_sign[i] for i in legs]
    numbers += [at(i, "thigh", "dq") * hip_sign[i] for i in legs]
    numbers += [at(i, "calf", "dq") / knee_sign[i] for i in legs]
    for key in ["kp", "kd"]:
        numbers += [gain(i, joint, key) for joint in JOINTS for i in legs]
    numbers += [at(i, "hip", "tau") * abad_sign[i] for i in legs]
    numbers += [at(i, "thigh", "tau") * hip_sign[i] for i in legs]
    numbers += [at(i, "calf", "tau") * knee_sign[i] for i in legs]
    said = struct.pack("<30f2i", *numbers, 1, 1)
    said += struct.pack("<I", reduce(lambda a, b: a ^ b, struct.unpack("<32I", said)))
    return b"".join(said[i : i + 2][::-1] for i in range(0, len(said), 2))


for name, frame in [("go2_low_cmd", go2()), ("cheetah_0", cheetah(0)), ("cheetah_1", cheetah(1))]:
    with open(f"{name}.bin", "wb") as file:
        file.write(frame)
