#!/usr/bin/python3
"""import ragdoll: the same bits as ragdoll_lab, errors, arrays, threads; the examples run."""

import ast
import json
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time
import unittest

import numpy as np
import ragdoll

LAB = os.environ['RAGDOLL_LAB']
PACKAGE = pathlib.Path(__file__).resolve().parents[2]
BODY = """
ragdolls: [{name: body, model: human, position: [0, 0, 2], rpy_deg: [%g, 25, %g]}]
obstacles: [{type: plane, friction: 0.5}]
pokes: [{at: 0.1, body: torso, force: [%g, 0, 0], duration: 0.1}]
solver: {preset: %s, step: 0.01, joint_damping: 2}
"""
FREE = """
gravity: [0, 0, -9.81]
ragdolls: [{name: body, model: human, position: [0, 0, 100]}]
solver: {step: 0.01}
"""


def lab_hash(scene, seconds, *settings):
    words = [w for s in settings for w in ('--set', s)]
    run = subprocess.run([LAB, 'run', str(scene), '--seconds', str(seconds), '--summary'] + words,
                         stdout=subprocess.PIPE, check=True)
    return json.loads(run.stdout.decode())['hash']


class WorldTest(unittest.TestCase):
    def test_the_hash_is_that_of_the_lab(self):
        for name, preset in (('stairs', 'balanced'), ('push', 'fast'), ('two', 'draft')):
            world = ragdoll.World(name, solver={'preset': preset})
            world.step(int(round(1.5 / world.step_length)))
            self.assertEqual(world.hash, lab_hash(name, 1.5, 'solver.preset=' + preset), name)

    def test_a_path_and_a_text_are_scenes_too(self):
        path = PACKAGE / 'scenes' / 'fall.yaml'
        worlds = [ragdoll.World('fall'), ragdoll.World(path), ragdoll.World(str(path)),
                  ragdoll.World(path.read_text())]
        for world in worlds:
            world.step(50)
        self.assertEqual(len({w.hash for w in worlds}), 1)

    def test_free_fall(self):
        world = ragdoll.World(FREE)
        start = world.positions
        world.step(100)
        n, h = 100, 0.01
        np.testing.assert_allclose(world.positions[:, 2] - start[:, 2], -9.81 * (n * h) ** 2 / 2,
                                   atol=1e-9)
        np.testing.assert_allclose(world.velocities[:, 2], -9.81 * n * h, atol=1e-9)
        self.assertAlmostEqual(world.time, 1)
        self.assertEqual((world.steps, world.step_length), (100, 0.01))

    def test_a_poke_gives_its_momentum(self):
        world = ragdoll.World(FREE, settings={'gravity': [0, 0, 0]})
        world.poke('torso', force=np.array([75, 0, 0]), duration=0.5)
        world.step(100)
        kinetic, _ = world.energy
        self.assertGreater(kinetic, 0.5 * 75 * (75 * 0.5 / 75) ** 2 - 1e-9)
        still = ragdoll.World(FREE, settings={'gravity': [0, 0, 0]})
        still.step(100)
        self.assertLess(still.energy[0], 1e-20)

    def test_arrays_are_copies_named_and_float64(self):
        world = ragdoll.World('two')
        before = world.positions
        kept = before.copy()
        world.step(10)
        np.testing.assert_array_equal(before, kept)
        self.assertEqual(before.dtype, np.float64)
        self.assertEqual(before.shape, (len(world.particles), 3))
        self.assertEqual(world.velocities.shape, before.shape)
        self.assertEqual(len(world.asleep), len(world.ragdolls))
        self.assertEqual(len(set(world.particles)), len(world.particles))
        position, turn = world.frame(world.frames[0])
        self.assertEqual((position.shape, turn.shape), ((3,), (4,)))
        self.assertAlmostEqual(np.linalg.norm(turn), 1)

    def test_contacts_carry_the_body(self):
        world = ragdoll.World('fall')
        world.step(1500)
        self.assertTrue(world.asleep.all())
        world.step(10)
        contacts = world.contacts
        self.assertGreater(len(contacts), 2)
        np.testing.assert_allclose(contacts['force'].sum(axis=0), [0, 0, 75 * 9.81], atol=1)
        self.assertTrue((contacts['normal'][:, 2] > 0.99).all())
        self.assertTrue(set(b.split('-')[0] for b in contacts['body']) <= set(world.particles))
        self.assertEqual(len(ragdoll.World('fall').contacts), 0)

    def test_imus_feel_nothing_in_free_fall(self):
        scene = FREE + """sensors:
  - {name: back, type: imu, segment: torso, position: [-0.1, 0, 0], rate: 50}
"""
        world = ragdoll.World(scene)
        world.step(20)
        imu = world.imu
        self.assertEqual(len(imu), 10)
        np.testing.assert_allclose(imu['time'], np.arange(1, 11) / 50)
        np.testing.assert_allclose(imu['acceleration'], 0, atol=1e-6)
        np.testing.assert_allclose(imu['angular_velocity'], 0, atol=1e-6)
        self.assertEqual(set(imu['sensor']), {'body/back'})
        world.step(4)
        self.assertEqual(len(world.imu), 2)

    def test_save_restore_and_reset(self):
        world = ragdoll.World('push')
        start = world.hash
        world.step(30)
        snapshot = world.save()
        world.step(60)
        then = world.hash
        world.restore(snapshot)
        world.step(60)
        self.assertEqual(world.hash, then)
        world.reset()
        self.assertEqual(world.hash, start)
        with self.assertRaisesRegex(ragdoll.Error, 'snapshot|damaged'):
            world.restore(b'nonsense')
        self.assertEqual(world.hash, start)

    def test_errors_say_what_is_wrong(self):
        world = ragdoll.World('fall')
        bad = [(lambda: ragdoll.World('no_such_scene'), 'stairs'),
               (lambda: ragdoll.World('ragdolls: [{model: human, mass: 3}]\n'), r'<text>:1.*mass'),
               (lambda: ragdoll.World('fall', solver={'preset': 'quick'}), 'quick.*balanced'),
               (lambda: ragdoll.World('fall', solver={'speed': 3}), 'speed'),
               (lambda: ragdoll.World('fall', solver=3), 'solver: is not a mapping'),
               (lambda: ragdoll.World('fall', solver={'tolerance': -1e-3}), r'tolerance is -0\.001; it must be 0'),
               (lambda: ragdoll.World('fall', solver={'tolerance': 1e-13}), 'tolerance is 1e-13; .* 1e-12'),
               (lambda: ragdoll.World('fall', solver={'tolerance': float('inf')}), "tolerance: is 'inf'"),
               (lambda: ragdoll.World(7), 'scene: is a int'),
               (lambda: world.poke('tail', (1, 0, 0)), 'tail.*head'),
               (lambda: world.poke('head', (1, 0)), 'force: has 2 numbers'),
               (lambda: world.poke('head', (float('nan'), 0, 0)), 'force: is not finite'),
               (lambda: world.poke('head', (1, 0, 0), duration=-3), 'duration'),
               (lambda: world.step(-1), 'steps: is -1'),
               (lambda: world.frame('tail'), 'tail'),
               (lambda: ragdoll.Fall(-1), r'seed: is -1; 0 \.\.\. 99999999 is'),
               (lambda: ragdoll.Fall(2 ** 64), 'seed: is 18446744073709551616'),
               (lambda: ragdoll.pose_class({}), "pose_class: there is no '"),
               (lambda: ragdoll.Crowd([]), 'there is none'),
               (lambda: ragdoll.Crowd('fall'), 'list'),
               (lambda: ragdoll.Crowd(['fall'], threads=-1), 'threads: is -1')]
        start = world.hash
        for call, words in bad:
            with self.assertRaisesRegex(ragdoll.Error, words):
                call()
        for call in (lambda: world.step(1.5), lambda: world.restore('text'), lambda: ragdoll.Fall(1e3),
                     lambda: ragdoll.pose_class(world.positions)):
            self.assertRaises(TypeError, call)
        self.assertEqual(world.hash, start)
        self.assertEqual(ragdoll.Fall(np.int64(7)).labels, ragdoll.Fall(7).labels)

    def test_the_gil_is_free_during_steps(self):
        world = ragdoll.World('stairs')
        counted = [0]
        done = threading.Event()

        def count():
            while not done.is_set():
                counted[0] += 1

        thread = threading.Thread(target=world.step, args=(1000,))
        counter = threading.Thread(target=count)
        thread.start()
        counter.start()
        seen = []
        while thread.is_alive() and len(seen) < 20:
            seen.append(world.time)  # waits for the steps, not for ever
        thread.join()
        done.set()
        counter.join()
        self.assertEqual(world.steps, 1000)
        self.assertGreater(counted[0], 1000)

    def test_ctrl_c_ends_a_long_step(self):
        code = ("import ragdoll\nw = ragdoll.World('stairs')\nprint('begin', flush=True)\n"
                "try:\n    w.step(10**11)\nexcept KeyboardInterrupt:\n    print('ended', w.steps)\n")
        run = subprocess.Popen([sys.executable, '-c', code], stdout=subprocess.PIPE)
        self.assertEqual(run.stdout.readline(), b'begin\n')
        time.sleep(0.2)
        run.send_signal(signal.SIGINT)
        out = run.communicate(timeout=60)[0].decode()
        self.assertEqual(out.split()[0], 'ended')


class CrowdTest(unittest.TestCase):
    def scenes(self, preset):
        return [BODY % (10 * i, 30 * i, 50 * i, preset) for i in range(11)]

    def test_each_is_as_it_is_alone(self):
        for preset in ('fast', 'balanced'):
            scenes = self.scenes(preset)
            alone = []
            for scene in scenes:
                world = ragdoll.World(scene)
                world.step(150)
                alone.append((world.hash, world.positions))
            for threads in (1, 2):
                crowd = ragdoll.Crowd(scenes, threads=threads)
                crowd.step(100)
                crowd.step(50)
                self.assertEqual(crowd.hashes, [a[0] for a in alone])
                np.testing.assert_array_equal(crowd.positions[3], alone[3][1])
                self.assertEqual(crowd.batches, 1)
                self.assertEqual(len(crowd), 11)

    def test_any_mix(self):
        scenes = ['fall', 'two', 'hang', 'stairs'] + self.scenes('balanced')[:3]
        crowd = ragdoll.Crowd(scenes, threads=2, solver={'step': 0.01})
        crowd.step(100)
        for scene, got, names in zip(scenes, crowd.hashes, crowd.particles):
            world = ragdoll.World(scene, solver={'step': 0.01})
            world.step(100)
            self.assertEqual(got, world.hash)
            self.assertEqual(names, world.particles)

    def test_a_poke_is_of_one_scene(self):
        crowd = ragdoll.Crowd(self.scenes('fast'))
        world = ragdoll.World(self.scenes('fast')[4])
        before = crowd.hashes
        for each in (crowd, world):
            each.step(20)
        crowd.poke(4, 'head', (0, 90, 0), duration=0.1)
        world.poke('head', (0, 90, 0), duration=0.1)
        others = ragdoll.Crowd(self.scenes('fast'))
        for each in (crowd, world):
            each.step(80)
        others.step(100)
        differ = [a != b for a, b in zip(crowd.hashes, others.hashes)]
        self.assertEqual(differ, [i == 4 for i in range(11)])
        self.assertEqual(crowd.hashes[4], world.hash)
        crowd.reset()
        self.assertEqual(crowd.hashes, before)


class PackageTest(unittest.TestCase):
    def test_everything_has_a_docstring_and_a_stub(self):
        stub = ast.parse((PACKAGE / 'python' / 'ragdoll' / '__init__.pyi').read_text())
        stubs = {}
        for node in stub.body:
            if isinstance(node, ast.ClassDef):
                stubs[node.name] = {n.name for n in node.body if isinstance(n, ast.FunctionDef)}
            elif isinstance(node, ast.FunctionDef):
                stubs[node.name] = set()
        for name in ragdoll.__all__:
            self.assertIn(name, stubs)
            kind = getattr(ragdoll, name)
            if name == 'Error':
                continue
            self.assertTrue(kind.__doc__, name)
            if isinstance(kind, type):
                public = {n for n in vars(kind) if not n.startswith('_') or n == '__len__'}
                self.assertEqual(public, stubs[name] - {'__init__'})
                for member in public - {'__len__'}:
                    self.assertTrue(getattr(kind, member).__doc__, name + '.' + member)

    def test_the_examples_run(self):
        for name, words in (('step_and_plot.py', 'fastest fall'), ('sweep.py', 'friction 0.8'),
                            ('random_pokes.py', 'again: True')):
            run = subprocess.run([sys.executable, str(PACKAGE / 'examples' / name)],
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT)
            self.assertEqual(run.returncode, 0, run.stdout.decode())
            self.assertIn(words, run.stdout.decode())


if __name__ == '__main__':
    unittest.main()
