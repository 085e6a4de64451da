#!/usr/bin/python3
"""Pokes a hanging body at random, then goes back to the worst moment and looks at it again."""
# %% Random, but the same each time.
import numpy as np
import ragdoll

random = np.random.RandomState(1)
world = ragdoll.World('hang')
world.step(240)  # it swings out

# %% 20 pokes, a fifth of a second apart.
fastest, moment = 0.0, world.save()
for _ in range(20):
    body = world.particles[random.randint(len(world.particles))]
    world.poke(body, force=random.normal(size=3) * 60, duration=0.05)
    before = world.save()
    world.step(24)
    speed = np.linalg.norm(world.velocities, axis=1).max()
    if speed > fastest:
        fastest, moment, then = speed, before, world.hash

# %% A restored moment goes on to the same bits.
world.restore(moment)
world.step(24)
print('fastest %.2f m/s, again: %s' % (fastest, world.hash == then))
