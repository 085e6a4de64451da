#!/usr/bin/python3
"""Steps a scene and plots how high head and hips are: python3 step_and_plot.py [OUT.png]"""
# %% A world is a scene that is stepped.
import sys

import numpy as np
import ragdoll

world = ragdoll.World('fall', solver={'preset': 'balanced'})
head, hip = world.particles.index('head'), world.particles.index('left_hip')

# %% Positions are (n, 3) arrays in metres: copies, to be kept.
every = 2
times, heights = [], []
for _ in range(int(3 / world.step_length) // every):
    world.step(every)
    times.append(world.time)
    heights.append(world.positions[[head, hip], 2])
heights = np.array(heights)
print('head: %.2f m at first, %.2f m at the end, fastest fall %.1f m/s' % (
    heights[0, 0], heights[-1, 0], -np.min(np.diff(heights[:, 0]) / np.diff(times))))

# %% The picture, where matplotlib is installed (python3-matplotlib).
if len(sys.argv) > 1:
    import matplotlib
    matplotlib.use('Agg')
    import matplotlib.pyplot as plt
    plt.plot(times, heights)
    plt.legend(['head', 'left hip'])
    plt.xlabel('time [s]')
    plt.ylabel('height [m]')
    plt.savefig(sys.argv[1])
