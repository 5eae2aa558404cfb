"""Prints what tests/film/difference.rs expects of FLIP and SSIM, from the authors' program and scikit-image.

pip install flip-evaluator==1.7 scikit-image==0.26.0
"""

import flip_evaluator
import numpy as np
from skimage.metrics import structural_similarity

W, H = 96, 64
y, x = np.meshgrid(np.arange(H, dtype=np.uint32), np.arange(W, dtype=np.uint32), indexing="ij")


def unit(seed):
    """A whole number of 256ths in [0, 1) for each pixel."""
    u = np.uint32
    h = x * u(0x9E3779B1) + y * u(0x85EBCA77) + u(seed * 0xC2B2AE3D & 0xFFFFFFFF)
    for shift, factor in ((15, 0x2C1B3C6D), (12, 0x297A2D39), (15, 1)):
        h = (h ^ (h >> u(shift))) * u(factor)
    return (h >> u(24)).astype(np.float32) / np.float32(256)


def picture(*channels):
    return np.ascontiguousarray(
        np.stack([np.broadcast_to(np.asarray(c, np.float32), (H, W)) for c in channels], -1)
    )


def checker(shift):
    return np.where(((x + shift) // 8 + y // 8) % 2 == 1, np.float32(0.75), np.float32(0.125))


u, v = x.astype(np.float32) / 128, y.astype(np.float32) / 64
plain = picture(u, v, checker(0))
noisy = np.clip(np.stack([plain[..., c] + (unit(c + 1) - np.float32(0.5)) / 4 for c in range(3)], -1), 0, 1)
steps = np.exp2((x // 8).astype(np.float32) - 6)
bright = picture(steps, steps * (0.5 + v / 2), steps * 0.25)
speck = np.stack([bright[..., c] * (np.float32(0.75) + unit(c + 4) / 2) for c in range(3)], -1)
pairs = {
    "noisy": (noisy, plain),
    "tinted": (picture(u, v / 2, checker(0)), plain),
    "moved": (picture(u, v, checker(3)), plain),
    "turned": (plain[::-1].copy(), plain),
    "speck": (speck, bright),
}


def luma(p):
    p = np.clip(p.astype(np.float64), 0, 1)
    coded = np.where(p <= 0.0031308, 12.92 * p, 1.055 * p ** (1 / 2.4) - 0.055)
    return coded @ np.array([0.2126, 0.7152, 0.0722])


def flip(truth, test, kind):
    found, _, used = flip_evaluator.evaluate(truth, test, kind, inputsRGB=False, applyMagma=False)
    return found.reshape(H, W, -1)[..., 0].astype(np.float64), used


for name, (test, truth) in pairs.items():
    test = test.astype(np.float32)
    similarity = structural_similarity(
        luma(test), luma(truth), data_range=1, gaussian_weights=True, sigma=1.5, use_sample_covariance=False
    )
    ldr, _ = flip(np.clip(truth, 0, 1), np.clip(test, 0, 1), "LDR")
    hdr, used = flip(truth, test, "HDR")
    pixels = ", ".join(f"{ldr[row, column]:.6f}" for column, row in ((0, 0), (40, 20), (95, 63)))
    exposures = f"{used['startExposure']:.5f}, {used['stopExposure']:.5f}, {used['numExposures']}"
    print(f"{name}: SSIM {similarity:.10f}, LDR {ldr.mean():.6f} [{pixels}], HDR {hdr.mean():.6f} ({exposures})")
