#!/usr/bin/env python3
# SPDX-License-Identifier: MIT OR Apache-2.0
"""The lined tunnel of `tunnel.toml` in powerhouse and in OpenSees, beside each other; see README.md.

    python3 tests/peers/run.py --powerhouse target/release/powerhouse
"""

import argparse
import csv
import resource
import shutil
import subprocess
import sys
import tempfile
import tomllib
from pathlib import Path

try:
    import numpy as np
except ImportError:
    sys.exit("needs NumPy and OpenSees: pip install numpy openseespy")

import in_opensees
from tunnel import Boundary, Medium, Tunnel, Wave

HERE = Path(__file__).parent
# Kernels of powerhouse beside elements of OpenSees.
PAIRS = [("hex8-full", "stdBrick"), ("hex8-b-bar", "bbarBrick"), ("hex8-natural", "SSPbrick")]
# Greatest relative L2 difference of a history, with the same steps and with implicit ones.
LIMITS = (0.001, 0.002)
# Bricks of the lining, the first clockwise from the crown first, through the middle of which a section goes.
SECTIONS = {"crown": 0, "shoulder": 5, "side": 11}


def sections_of(tunnel):
    """By name the brick, and the text of the request."""
    found = {}
    for name, brick in SECTIONS.items():
        points = tunnel.points[tunnel.bricks["lining"][brick]]
        middle = points.mean(axis=0)
        ends = points[[1, 2, 5, 6]].mean(axis=0) - points[[0, 3, 4, 7]].mean(axis=0)
        text = [f'[[output.section]]\nname = "{name}-section"\nset = "lining"', f"at = {middle.tolist()}",
                f"normal = {ends.tolist()}", "along = [0, 1, 0]\nhalf_extent = 2\n"]
        found[name] = (brick, "\n".join(text))
    return found


def in_powerhouse(command, scene, folder, kernel, columns):
    """Histories of some columns, and the processor seconds that the run took."""
    keys = [f"part.{name}.kernel={kernel}" for name in ("rock", "lining")]
    arguments = [command, "run", scene, "--out", folder, "--threads", "1", "--quiet"]
    began = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime
    subprocess.run([*arguments, *(word for key in keys for word in ("--set", key))], check=True)
    seconds = resource.getrusage(resource.RUSAGE_CHILDREN).ru_utime - began
    found = {}
    for name in ("histories", "sections"):
        with open(folder / f"{name}.csv", newline="") as file:
            head, *rows = csv.reader(line for line in file if not line.startswith("#"))
        names = [column.split(" ")[0] for column in head]
        found |= dict(zip(names, np.array(rows, float).T))
    return np.array([found[column] for column in columns]).T, seconds


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--powerhouse", default="powerhouse", help="the command of powerhouse")
    parser.add_argument("--out", type=Path, help="a folder for mesh, scene and results; by default one that is removed")
    parser.add_argument("--implicit", action="store_true", help="OpenSees takes Newmark's steps, ten times as long")
    parser.add_argument("--pair", type=int, action="append", help="number of a pair of elements, from 0; all by default")
    arguments = parser.parse_args()
    opensees = in_opensees.load()
    if opensees is None:
        sys.exit("needs OpenSees, which is not there or has no wheel for this machine: pip install openseespy")
    if shutil.which(arguments.powerhouse) is None:
        parser.error(f"there is no command {arguments.powerhouse}: cargo build --release -p powerhouse-cli")
    with tempfile.TemporaryDirectory() as temporary:
        within = compare(opensees, arguments.powerhouse, arguments.out or Path(temporary),
                         arguments.pair or range(len(PAIRS)), arguments.implicit)
    sys.exit(not within)


def compare(opensees, command, folder, pairs, implicit):
    """Prints the greatest relative L2 differences of histories for each pair; whether all are within the limit."""
    folder.mkdir(parents=True, exist_ok=True)
    scene = tomllib.loads((HERE / "tunnel.toml").read_text())
    tunnel = Tunnel()
    sections = sections_of(tunnel)
    tunnel.write(folder / "tunnel.msh")
    text = (HERE / "tunnel.toml").read_text() + "".join(text for _, text in sections.values())
    (folder / "tunnel.toml").write_text(text)

    materials = {material["name"]: Medium(material) for material in scene["material"]}
    media = {part["set"]: materials[part["material"]] for part in scene["part"]}
    wave = Wave(media["rock"], scene["wave"][0], tunnel.points.min(axis=0) * [1, 0, 1])
    step, duration, interval = scene["time"]["step"], scene["time"]["duration"], scene["output"]["every"]
    times = np.arange(round(duration / step) + 1) * step
    boundary = Boundary(tunnel, media["rock"], scene["boundary"], wave, times)
    places = {history["name"]: np.array(history["at"]) for history in scene["output"]["history"]}
    columns = [f"{place}.{axis}" for place in places for axis in ("ux", "uz")]
    columns += [f"{name}-section.{force}_per_metre" for name in sections for force in ("axial", "shear", "moment")]

    count = sum(map(len, tunnel.bricks.values()))
    scheme = "Newmark's steps ten times as long" if implicit else "the same central differences"
    print(f"{count} bricks, {len(tunnel.points)} nodes, {len(times) - 1} steps of {step} s; "
          f"OpenSees {opensees.version()}, {scheme}\n")
    print("| powerhouse | OpenSees | displacement | axial force | shear force | moment | powerhouse (s) | OpenSees (s) |")
    print("|---|---|---|---|---|---|---|---|")
    rows, within = round(duration / interval), True
    for kernel, element in (PAIRS[i] for i in pairs):
        ours, seconds = in_powerhouse(command, folder / "tunnel.toml", folder / kernel, kernel, columns)
        theirs, their_seconds = in_opensees.run(opensees, tunnel, media, boundary, element, step, rows,
                                                round(interval / step), places, sections, implicit)
        np.savez(folder / f"{kernel}.npz", ours=ours, theirs=theirs, columns=columns)
        errors = np.linalg.norm(ours - theirs, axis=0) / np.linalg.norm(theirs, axis=0)
        cells = [max(error for column, error in zip(columns, errors) if word in column)
                 for word in (".u", ".axial", ".shear", ".moment")]
        within &= max(cells) <= LIMITS[implicit]
        percent = " | ".join(f"{100 * cell:.2g} %" for cell in cells)
        print(f"| `{kernel}` | `{element}` | {percent} | {seconds:.1f} | {their_seconds:.0f} |", flush=True)
    return within


if __name__ == "__main__":
    main()
