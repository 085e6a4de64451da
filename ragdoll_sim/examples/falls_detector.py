#!/usr/bin/python3
"""A detector of falls before the impact: one threshold on one IMU, trained on 2000 falls, tested on 500.

  python3 falls_detector.py [FOLDER [TRAIN TEST]]    makes the falls there (of seeds 1 ... 2500) if they are not there
"""
import os
import subprocess
import sys

import h5py
import numpy as np

WARNING = 0.1  # [s] an alarm that comes later than this before the impact is too late
SHARE = 0.95   # of the training falls that are to be found in time


def falls(folder, first, count):
    """Features (falls, T, 2) of the low back's IMU, times, labels; of the falls that hit something."""
    path = os.path.join(folder, 'falls_%d_%d.h5' % (first, count))
    if not os.path.exists(path):
        subprocess.run([os.environ.get('RAGDOLL_LAB', 'ragdoll_lab'), 'falls', '--first', str(first),
                        '--count', str(count), '--out', path, '--no-positions', '--threads', '0',
                        '--seconds', '4', '--set', 'solver.preset=fast'], check=True)
    with h5py.File(path, 'r') as file:
        labels = file['labels'][()]
        labels = labels[np.isfinite(labels['impact_time']) & (labels['impact_time'] > labels['onset_time'] + WARNING)]
        groups = [file['falls/%08d' % seed] for seed in labels['seed']]
        time = groups[0]['time'][()]
        imu = np.array([group['imu/low_back'][()] for group in groups], float)
    return features_of(imu), time, labels


def features_of(imu):
    """Lightness and turning [rad/s] (falls, T, 2) of an IMU (falls, T, 6) at 100 Hz, means over 50 ms."""
    kernel = np.ones(5) / 5
    smooth = np.apply_along_axis(lambda x: np.convolve(x, kernel)[:len(x)], 1, imu)
    smooth[:, :4] = smooth[:, 4:5]
    lightness = np.maximum(0, 1 - np.linalg.norm(smooth[..., :3], axis=2) / 9.81)  # 1: free fall
    return np.stack([lightness, np.linalg.norm(smooth[..., 3:], axis=2)], axis=2)


def peaks(score, time, labels):
    """The largest score of each fall while a warning is still of use."""
    late = time[None] > labels['impact_time'][:, None] - WARNING
    return np.where(late, 0, score).max(axis=1)


def train(features, time, labels):
    """Weight of the turning and the highest threshold that finds SHARE of the falls in time."""
    best = (0, 0, 0)
    for weight in np.linspace(0, 2, 41):
        peak = peaks(features @ [1, weight], time, labels)
        threshold = np.quantile(peak, 1 - SHARE)
        best = max(best, (threshold / np.median(peak), weight, threshold))
    return best[1:]


def first_alarms(features, time, weight, threshold):
    """[s] of each fall's; inf: none."""
    alarms = features @ [1, weight] > threshold
    return np.where(alarms.any(axis=1), time[alarms.argmax(axis=1)], np.inf)


def main(folder='.', train_count=2000, test_count=500):
    weight, threshold = train(*falls(folder, 1, train_count))
    print('alarm: lightness + %.2f s/rad * turning > %.3f' % (weight, threshold))
    features, time, labels = falls(folder, 1 + train_count, test_count)
    first = first_alarms(features, time, weight, threshold)
    lead, early = labels['impact_time'] - first, first <= labels['onset_time']
    found = (lead >= WARNING) & ~early
    print('%d falls: %.1f %% found %.0f ms or more before the impact, %.1f %% alarms before the onset' % (
        len(labels), 100 * found.mean(), 1000 * WARNING, 100 * early.mean()))
    print('lead time: median %.0f ms, quartiles %.0f and %.0f ms' % tuple(
        1000 * np.quantile(lead[found], [0.5, 0.25, 0.75])))
    for kind in np.unique(labels['kind']):
        own = labels['kind'] == kind
        print('  %-6s %5.1f %% of %d, median %.0f ms' % (
            kind.decode(), 100 * found[own].mean(), own.sum(), 1000 * np.median(lead[own & found])))


if __name__ == '__main__':
    main(*sys.argv[1:2], *map(int, sys.argv[2:4]))
