"""gauss and uniform: published vectors of Philox4x32-10, moments, and identical bits after rollbacks, in all forms and lanes."""

import subprocess

import numpy as np
import pytest
from scipy.special import ndtri

import fmi3
from ensemble_runs import NUMBERS, ensemble
from fmu import ROOT, build_systems, lagc

# Random123, kat_vectors: counter, key, block.
VECTORS = [
    ("00000000 00000000 00000000 00000000", "00000000 00000000", "6627e8d5 e169c58d bc57ac4c 9b00dbd8"),
    ("ffffffff ffffffff ffffffff ffffffff", "ffffffff ffffffff", "408f276d 41c83b0e a20bc7c6 6d5451fd"),
    ("243f6a88 85a308d3 13198a2e 03707344", "a4093822 299f31d0", "d16cfe09 94fdcceb 5001e420 24126ea1"),
]
PROGRAM = """#include <stdio.h>
#include "random_numbers.h"
int main(void) {
  unsigned c[4], k[2], count;
  while (scanf("%x %x %x %x %x %x", c, c + 1, c + 2, c + 3, k, k + 1) == 6) {
    uint32_t block[4] = {c[0], c[1], c[2], c[3]}, key[2] = {k[0], k[1]};
    random_block(block, key);
    printf("%08x %08x %08x %08x\\n", block[0], block[1], block[2], block[3]);
  }
  if (scanf(" moments %u", &count) != 1) return 1;
  for (unsigned i = 0; i < count; i++) printf("%a %a\\n", random_uniform(7, i), random_gauss(7, i));
  for (int i = 1; i < 1000; i++) printf("%a %a\\n", random_quantile(i / 1000.0), random_quantile(ldexp(1, -i % 1000 / 20 - 2)));
}
"""
NOISE = """<system name="{name}"><parameter name="seed" start="3"/><coordinate name="x" velocity="v"/><particle mass="1" x="x"/>
<force coordinate="x">gauss(seed, floor(time/0.1)) + uniform(2, 10*time) - 10*x</force><mode name="k"/>
<event when="time - 0.35" direction="rising"><set mode="k">uniform(seed, -4)</set></event>
<output name="o">gauss(seed, 12)</output><output name="p">uniform(seed, 1e15)</output>{solver}</system>"""


@pytest.fixture(scope="module")
def built():
    build_systems("random", {"Noise": NOISE.format(name="Noise", solver='<solver tolerance="1e-11"/>'), "NoiseRadau": NOISE.format(name="NoiseRadau", solver='<solver method="radau" tolerance="1e-10"/>')})
    build_systems("random-tables", {"NoiseTables": NOISE.format(name="NoiseTables", solver='<solver tolerance="1e-11"/>')}, "--form", "tables")


def philox(k, seed, domain):
    """Philox4x32-10 as published, in Python integers."""
    c, key = [k & 0xFFFFFFFF, k >> 32 & 0xFFFFFFFF, domain, 0], [seed & 0xFFFFFFFF, seed >> 32 & 0xFFFFFFFF]
    for _ in range(10):
        low, high = 0xD2511F53 * c[0], 0xCD9E8D57 * c[2]
        c = [high >> 32 ^ c[1] ^ key[0], high & 0xFFFFFFFF, low >> 32 ^ c[3] ^ key[1], low & 0xFFFFFFFF]
        key = [(key[0] + 0x9E3779B9) & 0xFFFFFFFF, (key[1] + 0xBB67AE85) & 0xFFFFFFFF]
    return c[0] << 32 | c[1]


def uniform(seed, k):
    return (philox(k, seed, 0) >> 11) * 2.0**-53


def gauss(seed, k):
    return ndtri(((philox(k, seed, 1) >> 12) + 0.5) * 2.0**-52)


def printed(tmp_path, compiler, *words):
    (tmp_path / "random.c").write_text(PROGRAM)
    subprocess.run([compiler, *words, f"-I{ROOT / 'include'}", tmp_path / "random.c", "-o", tmp_path / "random", "-lm"], check=True)
    given = "".join(f"{counter} {key}\n" for counter, key, _ in VECTORS) + "moments 200000\n"
    return subprocess.run([tmp_path / "random"], input=given, capture_output=True, text=True, check=True).stdout.splitlines()


def test_published_vectors_and_moments(tmp_path):
    lines = printed(tmp_path, "gcc", "-O2", "-std=c11")
    assert lines[:3] == [block for _, _, block in VECTORS]
    numbers = np.array([[float.fromhex(word) for word in line.split()] for line in lines[3:]])
    count = 200000
    u, g = numbers[:count].T
    assert u[:50].tolist() == [uniform(7, k) for k in range(50)]
    np.testing.assert_allclose(g[:50], [gauss(7, k) for k in range(50)], rtol=1e-13)
    for power in (1, 2, 3, 4):  # raw moments, within 5 standard deviations
        assert abs(np.mean(u**power) - 1 / (power + 1)) < 5 * np.sqrt((1 / (2 * power + 1) - 1 / (power + 1) ** 2) / count)
    for power, mean, variance in [(1, 0, 1), (2, 1, 2), (3, 0, 15), (4, 3, 96)]:
        assert abs(np.mean(g**power) - mean) < 5 * np.sqrt(variance / count)
    assert abs(np.mean(g[1:] * g[:-1])) < 5 / np.sqrt(count) and abs(np.mean(g * (u - 0.5))) < 5 * np.sqrt(1 / 12 / count)
    found = numbers[count:]
    np.testing.assert_allclose(found[:, 0], ndtri(np.arange(1, 1000) / 1000), rtol=1e-14, atol=1e-16)
    np.testing.assert_allclose(found[:, 1], ndtri([2.0 ** -(i % 1000 // 20 + 2) for i in range(1, 1000)]), rtol=2e-14)


def test_the_same_bits_by_any_compiler(tmp_path):
    """Compilers and flags do not change the bits, even where they may fuse products and sums."""
    expected = printed(tmp_path, "gcc", "-O0", "-std=c11")
    for words in (["gcc", "-O3", "-std=gnu11", "-mfma", "-ffp-contract=fast"], ["clang", "-O3", "-mfma", "-ffp-contract=fast"]):
        assert printed(tmp_path, *words) == expected


def noisy(t, seed=3):
    """x'' = f - 10 x in closed form between the instants at which either random number changes, with f from Python's numbers."""
    x, v, now, w = 0.0, 0.0, 0.0, np.sqrt(10)
    edges = sorted({*np.arange(1, 200) * 0.1, *(np.arange(200) * 0.1 + 0.05)})
    for end in [*(e for e in edges if e < t), t]:
        middle, s = (now + end) / 2, end - now
        rest = (gauss(seed, int(middle / 0.1)) + uniform(2, int(10 * middle + 0.5))) / 10
        x, v, now = rest + (x - rest) * np.cos(w * s) + v / w * np.sin(w * s), v * np.cos(w * s) - (x - rest) * w * np.sin(w * s), end
    return x, v


@pytest.mark.parametrize("name", ["Noise", "NoiseTables", "NoiseRadau"])
def test_noise_moves(built, open_fmu, name):
    instance = open_fmu(name).initialize()
    assert instance.get("p") == uniform(3, 10**15) and instance.get("o") == pytest.approx(gauss(3, 12), rel=1e-14)
    for t in [0.04, 0.17, 0.5, 1.23, 2.0]:
        instance.step(t - instance.time)
        assert (instance.get("x"), instance.get("v")) == pytest.approx(noisy(t), abs=1e-8), t
    assert instance.get("k") == uniform(3, -4)


def test_rollbacks_repeat_it_bit_for_bit(built, open_fmu):
    instance = open_fmu("Noise").initialize()
    instance.step(0.33)
    state = instance.fmu.getFMUState()
    runs = []
    for _ in range(2):
        instance.fmu.setFMUState(state)
        instance.time = 0.33
        for _ in range(20):
            instance.step(0.07)
        runs.append((instance.get("x"), instance.get("v")))
    instance.fmu.freeFMUState(state)
    assert runs[0] == runs[1]


# Noise in a rate, in a force and in a sampled measurement.
ROLLED = """<system name="Rolled{method}"><parameter name="seed" type="Integer" start="7"/><coordinate name="x" velocity="v" start="0.3"/><particle mass="1" x="x"/>
  <potential>4*x^2</potential><state name="z" rate="gauss(seed, floor(time/0.013)) - z + 0.1*v"/><mode name="measured"/>
  <sample every="0.01"><set mode="measured">x + 0.01*gauss(seed, round(time/0.01))</set></sample>
  <force coordinate="x">-measured - v + z + uniform(seed, floor(time/0.05))</force><solver method="{method}" tolerance="1e-8"/></system>"""
METHODS = ["taylor", "erk", "radau", "auto", "bdf"]


def test_rollbacks_in_all_methods(open_fmu):
    """
    A step that is repeated after others gives the same bits, in FMI 2.0 and 3.0, and both versions the same motion; `bdf` keeps its tolerance.
    """
    build_systems("rolled", {f"Rolled{method}": ROLLED.format(method=method) for method in METHODS}, versions=(2, 3))
    names = ["x", "v", "z", "measured"]
    for method in METHODS:
        ends = []
        for instance, letter in ((open_fmu(f"Rolled{method}"), "s"), (fmi3.Instance(f"Rolled{method}"), "S")):
            calls, lengths, time = instance.fmu, np.random.default_rng(1).uniform(0.003, 0.08, 20), 0.0
            instance.initialize()
            for length in lengths:
                state = getattr(calls, f"getFMU{letter}tate")()
                calls.doStep(time, length)
                first = list(instance.get(*names))
                calls.doStep(time + length, length)
                getattr(calls, f"setFMU{letter}tate")(state)
                calls.doStep(time, length)
                again = list(instance.get(*names))
                calls.freeFMUState(state) if letter == "S" else instance.free_state(state)
                assert again == (pytest.approx(first, rel=1e-6) if method == "bdf" else first), (method, time)
                time += length
            ends.append(again)
            calls.terminate()
        assert ends[0] == ends[1]


def test_lanes_have_the_same_noise(built):
    """Each run of a sweep has its own seed; runs with the same seed are identical."""
    rows = np.array([[0.0], [1.0], [3.0], [3.0], [-7.0], [1e9]])
    for lanes in NUMBERS:
        values, needs_fmu = ensemble("Noise", ["seed"], ["x", "v", "o"], [0, 1.7], lanes).run(rows)
        assert not needs_fmu.any()
        for (seed,), (_, (x, v, o)) in zip(rows, values):
            assert (x, v, o) == pytest.approx((*noisy(1.7, int(seed)), gauss(int(seed), 12)), abs=1e-8)
        np.testing.assert_array_equal(values[2], values[3])


@pytest.mark.parametrize("expression, message", [
    ("gauss(time, 1)", "the seed of gauss changes in time; expected a number or a parameter"), ("gauss(1)", "expected ',' between the two arguments of gauss"),
    ("rand(1)", "write uniform(seed, k)"),
])  # fmt: skip
def test_messages(tmp_path, expression, message):
    (tmp_path / "system.xml").write_text(f'<system name="X"><output name="o">{expression}</output></system>')
    assert message in lagc("system.xml", "-o", "out", cwd=tmp_path).stderr
