#!/usr/bin/python3
"""How far a body slides down a slope, by the friction of it: a scene for each value, stepped together."""
# %% A scene is a name, a path, or text.
import ragdoll

SCENE = """
ragdolls: [{name: body, model: human, position: [0, 0, 0.4], rpy_deg: [0, -90, 0], velocity: [3, 0, 0]}]
obstacles: [{type: plane, friction: %g}]
solver: {joint_damping: 2}
"""
frictions = [0.1, 0.2, 0.3, 0.4, 0.6, 0.8]
crowd = ragdoll.Crowd([SCENE % friction for friction in frictions], threads=2,
                      solver={'preset': 'fast', 'step': 0.005})
starts = [x.mean(axis=0) for x in crowd.positions]

# %% All of them, three seconds.
crowd.step(int(3 / crowd.step_length))
slides = [(x.mean(axis=0) - start)[0] for x, start in zip(crowd.positions, starts)]
for friction, way in zip(frictions, slides):
    print('friction %.1f: %.2f m' % (friction, way))
