#!/usr/bin/python3
"""Draws the pictures of docs/data.md from a file of falls, with gnuplot.

  ragdoll_lab falls --first 1 --count 2000 --out falls.h5 --threads 0 --set solver.preset=fast
  falls_pictures.py falls.h5 docs/images [--seed SEED]

fall_imu.png: the low back's IMU in a fall, under its body at five moments. impact_speeds.png: how fast
bodies hit, kind by kind.
"""

import argparse
import os
import subprocess
import sys

import h5py
import numpy as np
import yaml

MOMENTS = 5
WIDTH, HEIGHT, TALLEST = 880, 255, 1.8  # of the first panel [pixels], [m]


def plot(commands):
    subprocess.run(['gnuplot'], input=commands, universal_newlines=True, check=True)


def block(name, rows):
    return '$%s << END\n%s\nEND\n' % (name, '\n'.join(' '.join('%g' % v for v in row) if len(row) else ''
                                                       for row in rows))


def bodies(file, group, moments, shown):
    """Sticks at these samples as lines, side by side along the time axis, of which `shown` [s] are seen."""
    names = file.attrs['particles'].split(',')
    model = yaml.safe_load(file.attrs['scene'])['ragdolls'][0]['model']
    sticks = [(s[0], s[1]) if isinstance(s, list) else (s['a'], s['b']) for s in model['sticks']]
    positions, time = group['positions'][()], group['time'][()]
    way = positions[moments[-1]].mean(axis=0)[:2] - positions[0].mean(axis=0)[:2]
    way = way / max(1e-6, np.linalg.norm(way))
    rows, scale = [], HEIGHT / TALLEST / WIDTH * shown  # [s/m]: as long as high
    for k in moments:
        middle = positions[k].mean(axis=0)[:2] @ way
        for a, b in sticks:
            for name in (a, b):
                x = positions[k, names.index(name)]
                rows.append((time[k] + scale * (x[:2] @ way - middle), x[2]))
            rows.append(())
    return rows


def draw_fall(file, seed, path):
    group = file['falls/%08d' % seed]
    labels, time, imu = group.attrs, group['time'][()], group['imu/low_back'][()]
    onset, impact = labels['onset_time'], labels['impact_time']
    begin, end = onset - 0.25, min(time[-1], impact + 0.9)
    moments = [int(round(t * file.attrs['rate'])) - 1 for t in np.linspace(onset, impact + 0.45, MOMENTS)]
    rows = np.column_stack([time, imu])
    marks = ''.join('set arrow from %g, graph 0 to %g, graph 1 nohead dt 2 lc rgb "%s"\n' % (t, t, c)
                    for t, c in ((onset, '#228833'), (impact, '#cc3311')))
    limits = 'set xrange [%g:%g]\n' % (begin, end)
    plot(block('body', bodies(file, group, moments, end - begin)) + block('imu', rows) + '''
set terminal pngcairo size 1000, 900 font ",12"
set output "%s"
set multiplot layout 3, 1 margins 0.09, 0.97, 0.07, 0.95 spacing 0.05
set grid lc rgb "#dddddd"
%s%s
set title "fall %d: %s, %s; onset (green) and impact (red)"
set ylabel "height [m]"
set yrange [0:%g]
plot $body using 1:2 with lines lw 2 lc rgb "#335577" notitle
unset title
set autoscale y
set ylabel "specific force [m/s^2]"
plot for [i=2:4] $imu using 1:i with lines lw 1.5 title word("x y z", i - 1)
set ylabel "angular velocity [rad/s]"
set xlabel "time [s]"
plot for [i=5:7] $imu using 1:i with lines lw 1.5 title word("x y z", i - 4)
unset multiplot
''' % (path, limits, marks, seed, labels['kind'].decode(), labels['start'].decode(), TALLEST))


def draw_speeds(labels, path):
    speeds = labels['impact_speed']
    kinds = sorted({k for k in labels['kind']})
    edges = np.arange(0, 7.01, 0.25)
    rows = np.column_stack([edges[:-1] + 0.125] + [
        np.histogram(speeds[labels['kind'] == k], edges)[0] / max(1, (labels['kind'] == k).sum()) for k in kinds])
    titles = ' '.join(k.decode() for k in kinds)
    plot(block('speeds', rows) + '''
set terminal pngcairo size 900, 420 font ",12"
set output "%s"
set grid lc rgb "#dddddd"
set xlabel "speed of what hits first [m/s]"
set ylabel "share of falls"
plot for [i=2:%d] $speeds using 1:i with histeps lw 2 title word("%s", i - 1)
''' % (path, len(kinds) + 1, titles))


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument('falls', help='file of ragdoll_lab falls, with positions')
    parser.add_argument('folder', help='for the pictures')
    parser.add_argument('--seed', type=int, help='of the fall that is drawn')
    arguments = parser.parse_args()
    if not os.path.exists(arguments.falls):
        sys.exit('falls_pictures: %s is not there; ragdoll_lab falls makes it' % arguments.falls)
    os.makedirs(arguments.folder, exist_ok=True)
    with h5py.File(arguments.falls, 'r') as file:
        labels = file['labels'][()]
        slips = labels['seed'][(labels['kind'] == b'slip') & np.isfinite(labels['impact_time'])]
        seed = arguments.seed if arguments.seed is not None else (slips if len(slips) else labels['seed'])[0]
        if '%08d' % seed not in file['falls']:
            sys.exit('falls_pictures: there is no fall %d in %s' % (seed, arguments.falls))
        draw_fall(file, seed, os.path.join(arguments.folder, 'fall_imu.png'))
        draw_speeds(labels, os.path.join(arguments.folder, 'impact_speeds.png'))


if __name__ == '__main__':
    main()
