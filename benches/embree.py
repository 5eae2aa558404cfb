"""Closest hits per second on one thread: caustica and Embree with the same mesh and rays.

    pip install embreex numpy
    cargo build --release --example rays
    python benches/embree.py target/release/examples/rays [ROUNDS]

Each variant traces 524,288 rays in turn, ROUNDS times (15). The script prints medians of the rates
and of the ratios within a round, and compares the hit distances. Variants: caustica one by one and
side by side, as the CPU engine traces photons in large scenes; Embree, called ray by ray by
embreex, with the default setup of embreex and with the robust flag (caustica's triangle test is
watertight).
"""

import statistics
import subprocess
import sys
import tempfile
import time

import numpy
from embreex.mesh_construction import TriangleMesh
from embreex.rtcore_scene import EmbreeScene


def main():
    program = sys.argv[1]
    rounds = int(sys.argv[2]) if len(sys.argv) > 2 else 15
    with tempfile.TemporaryDirectory() as folder:
        ours = subprocess.Popen([program, folder], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        print(ours.stdout.readline().strip())
        triangles = numpy.fromfile(folder + "/triangles.f32", numpy.float32).reshape(-1, 3, 3)
        rays = numpy.fromfile(folder + "/rays.f32", numpy.float32).reshape(-1, 8)
        origins, directions = rays[:, 0:3].copy(), rays[:, 4:7].copy()
        scenes = {name: EmbreeScene(robust=name == "robust") for name in ("default", "robust")}
        for scene in scenes.values():
            TriangleMesh(scene, triangles)
            scene.run(origins[:100], directions[:100])
        ways = ("one by one", "side by side")
        rates = {name: [] for name in (*ways, *scenes)}
        for _ in range(rounds):
            ours.stdin.write("\n")
            ours.stdin.flush()
            for way, seconds in zip(ways, ours.stdout.readline().split()):
                rates[way].append(len(rays) / float(seconds))
            for name, scene in scenes.items():
                start = time.perf_counter()
                scene.run(origins, directions)
                rates[name].append(len(rays) / (time.perf_counter() - start))
        ours.stdin.close()
        ours.wait()
        distances = numpy.fromfile(folder + "/distances.f32", numpy.float32)
        theirs = scenes["robust"].run(origins, directions, output=True)
    for name, list in rates.items():
        print(f"{name:12} {statistics.median(list) * 1e-6:.3f} M rays/s, best {max(list) * 1e-6:.3f}")
    for way in ways:
        for name in scenes:
            ratio = statistics.median(a / b for a, b in zip(rates[way], rates[name]))
            print(f"ours {way} / Embree ({name}): {ratio:.2f}")
    met = theirs["primID"] >= 0
    far = numpy.abs(distances[met] - theirs["tfar"][met]) > 1e-4
    print(f"hits: Embree {met.sum()}, ours {(distances < 1e29).sum()}; {far.sum()} distances differ by more than 1e-4")


main()
