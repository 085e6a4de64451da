#!/usr/bin/python3
"""ragdoll_lab replay: a recorded run again, bit for bit, or the first thing that differs."""

import csv
import math
import os
import shutil
import struct
import subprocess
import sys
import tempfile
import threading
import unittest

import genpy.dynamic
import rosbag
import roslib.packages
import rospy
import rostest
from bags import Recorder
from client import LIMIT, Client, Inbox, wait_for
from dynamic_reconfigure.client import Client as Settings
from geometry_msgs.msg import Vector3, WrenchStamped
from ragdoll_msgs.msg import ContactStates, FollowedFrame, Model
from ragdoll_msgs.srv import Attach, Detach, SetState
from std_msgs.msg import String
from tf2_ros import TransformBroadcaster, TransformStamped

NODE = '/puppet'
TOPICS = [NODE + '/' + name for name in ('model', 'state', 'pokes', 'followed')]
HANGING = '''
ragdolls: [{name: anna, model: human, position: [0, 0, 2]}]
pins: [anna/right_hand]
'''
PUSHED = '''
ragdolls: [{name: ragdoll, model: human, position: [0.7, 0, 0.3], rpy_deg: [0, -90, 0]}]
obstacles:
  - {type: plane}
  - {type: box, frame: paddle, position: [0, 0, 0], size: [0.1, 2, 0.6]}
'''
SOFT = PUSHED.replace('model: human', 'model: human, contact: compliant') + '''
self_collision: true
solver: {step: 0.016666666666666666}
'''


def lab(*arguments):
    """(exit status, stdout, stderr)"""
    program = roslib.packages.find_node('ragdoll_sim', 'ragdoll_lab')[0]
    run = subprocess.run([program] + list(arguments), timeout=4 * LIMIT, stdout=subprocess.PIPE,
                         stderr=subprocess.PIPE, universal_newlines=True)
    return run.returncode, run.stdout, run.stderr


def replay(path, *arguments):
    return lab('replay', path, *arguments)


def flipped(value):
    """The number next to it: its last bit is the other one."""
    bits = struct.unpack('<Q', struct.pack('<d', value))[0]
    return struct.unpack('<d', struct.pack('<Q', bits ^ 1))[0]


def is_one_step(contacts):
    """Not of a late tick, of several steps."""
    return abs(60 * contacts.interval - 1) < 1e-9


class Robot(threading.Thread):
    """Publishes frames at 50 Hz that go to and fro and turn, until told not to."""

    def __init__(self, frames):
        super().__init__(daemon=True)
        self.frames, self.going = frames, True
        self.broadcaster = TransformBroadcaster()
        self.start()

    def stop(self):
        self.going = False
        self.join()

    def run(self):
        while self.going:
            now = rospy.Time.now()
            for i, frame in enumerate(self.frames):
                t = TransformStamped()
                t.header.stamp = now
                t.header.frame_id, t.child_frame_id = 'world', frame
                t.transform.translation = Vector3(
                    0.4 * math.sin(2 * now.to_sec()) - 0.5, 0.1 * i, 0.3 + 0.5 * i)
                turn = 0.2 * math.sin(3 * now.to_sec())
                t.transform.rotation.z, t.transform.rotation.w = math.sin(turn), math.cos(turn)
                self.broadcaster.sendTransform(t)
            rospy.rostime.wallsleep(0.02)


class LabReplayTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.client = Client(NODE)
        cls.restore = cls.client.service('set_state', SetState)
        cls.wrench = rospy.Publisher(NODE + '/wrench', WrenchStamped, queue_size=100)
        wait_for(lambda: cls.wrench.get_num_connections() > 0, 'the node')

    def setUp(self):
        self.folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, self.folder)
        self.path = os.path.join(self.folder, 'run.bag')
        self.client.load(path='fall')
        self.assertTrue(self.client.call_pause(False).success)

    def go(self, steps):
        """Waits until the node has told that it has made so many more steps."""
        begin = self.client.call_get().state

        def made():
            last = self.client.states.all()[-1]
            return last.run == begin.run and last.step >= begin.step + steps
        wait_for(made, 'steps')

    def push(self, times):
        """A stream of forces on two frames, as a controller gives it."""
        for i in range(times):
            for frame, force in (('left_hand', 30.0), ('pelvis', 5.0 * i)):
                message = WrenchStamped()
                message.header.frame_id = 'ragdoll/' + frame
                message.wrench.force.z, message.wrench.torque.x = force, 0.1 * i
                self.wrench.publish(message)
            self.go(5)

    def record_pokes(self):
        """A bag with a reset, pokes of all kinds and wrenches in it."""
        recorder = Recorder(self.path, NODE, TOPICS)
        self.assertTrue(self.client.call_reset().success)
        self.go(20)
        self.assertTrue(self.client.poke('head', (60, 20, 0), duration=0.3).success)
        self.assertTrue(self.client.poke('right_forearm', (0, 90, 0), frame='ragdoll/head',
                                         duration=-1).success)
        self.push(20)
        self.assertTrue(self.client.call_clear().success)
        self.assertTrue(self.client.poke('torso', (0, 0, 300), point=(0.1, 0.2, 0),
                                         duration=0.2).success)
        self.go(60)
        self.assertTrue(self.client.call_reset().success)
        self.assertTrue(self.client.poke('head', (200, 0, 0), duration=0.1).success)
        self.go(60)
        recorder.stop()

    def altered(self, change):
        """A copy of the bag, each of whose messages change(topic, message) has seen."""
        path = os.path.join(self.folder, 'altered.bag')
        with rosbag.Bag(self.path) as source, rosbag.Bag(path, 'w') as copy:
            for topic, message, t in source.read_messages():
                if change(topic, message) is not False:
                    copy.write(topic, message, t)
        return path

    def test_contacts_are_those_of_the_run(self):
        """To the bit, though nobody listened to them when it was recorded."""
        recorder = Recorder(self.path, NODE, TOPICS)
        self.client.load(path='fall')
        self.go(240)
        recorder.stop()
        again, once = (os.path.join(self.folder, name) for name in ('again.csv', 'once.csv'))
        status, out, errors = replay(self.path, '--contacts', again)
        self.assertEqual((status, errors), (0, ''), out)
        status, out, errors = lab('run', 'fall', '--seconds', '2', '--contacts', once)
        self.assertEqual((status, errors), (0, ''), out)
        with open(again) as a, open(once) as o:
            told, rows = set(a), list(o)
        rows = [row for row in rows[1:] if float(row.split(',')[0]) < 1.9]
        self.assertGreater(len(rows), 50)
        self.assertEqual([row for row in rows if row not in told], [])

    def test_contacts_are_those_that_were_published(self):
        """To the bit, with what gives way, is poked and is pushed by a frame of another node."""
        robot = Robot(['paddle'])
        self.addCleanup(robot.stop)
        heard = Inbox(NODE + '/contacts', ContactStates)
        recorder = Recorder(self.path, NODE, TOPICS)
        self.client.load(yaml=SOFT)
        self.go(60)
        self.assertTrue(self.client.poke('torso', (0, 200, 300), duration=0.2).success)
        self.go(120)
        for _ in range(20):
            if any(c.other.startswith('box') for m in heard.all() if is_one_step(m)
                   for c in m.contacts):
                break
            self.go(30)
        recorder.stop()
        path = os.path.join(self.folder, 'contacts.csv')
        status, out, errors = replay(self.path, '--contacts', path)
        self.assertEqual((status, errors), (0, ''), out)

        rows = {}
        with open(path) as file:
            for row in csv.reader(list(file)[1:]):
                step = round(60 * float(row[0]))
                if rows and step < max(rows):
                    rows = {}  # another run begins
                rows.setdefault(step, []).append(row[1:4] + [float(value) for value in row[4:]])
        told = {}
        for m in heard.all():
            if told and m.step < max(told):
                told = {}
            if not is_one_step(m):
                continue
            told[m.step] = [[c.ragdoll, c.body, '/'.join(filter(None, (c.other, c.other_body)))] +
                            [getattr(v, axis) for v in (c.position, c.normal) for axis in 'xyz'] +
                            [c.depth, c.force.x, c.force.y, c.force.z, c.peak_force, c.impulse,
                             c.slip] for c in m.contacts]
        both = [step for step in told if step <= max(rows)]
        self.assertGreater(len(both), 60)
        self.assertGreater(sum(len(told[step]) for step in both), 200)
        self.assertTrue(any(row[2].startswith('box') for step in both for row in told[step]))
        for step in both:
            self.assertEqual(rows.get(step, []), told[step], step)

    def test_a_run_with_pokes_is_identical(self):
        self.record_pokes()
        status, out, errors = replay(self.path)
        self.assertEqual((status, errors), (0, ''), out)
        runs = [line for line in out.splitlines() if 'identical' in line]
        self.assertGreaterEqual(len(runs), 2)  # before and after the second reset
        self.assertNotIn('not compared', out)

        # One bit of one number of one state.
        states = {}

        def count(topic, message):
            if topic == TOPICS[1] and message.step > 50:
                states[message.run] = message.step
        self.altered(count)
        run = max(states)
        seen = []

        def flip(topic, message):
            if topic == TOPICS[1] and message.run == run and message.step > 30 and not seen:
                seen.append(message.step)
                body = message.ragdolls[0]
                body.positions[7].y = flipped(body.positions[7].y)
        status, out, errors = replay(self.altered(flip))
        particle = self.client.model.ragdolls[0].particles[7]
        self.assertEqual((status, errors), (1, ''), out)
        differing = [line for line in out.splitlines() if 'differs' in line]
        self.assertEqual(len(differing), 1, out)
        self.assertIn('run %d: differs at step %d: particle ragdoll/%s: position y'
                      % (run, seen[0], particle), differing[0])

        # A poke that was another, and one that is missing.
        def weaker(topic, message):
            if topic == TOPICS[2] and message.body_name == 'ragdoll/torso':
                message.force.z = flipped(message.force.z)
        self.assertEqual(replay(self.altered(weaker))[0], 1)
        status, out, _ = replay(self.altered(lambda topic, _: topic != TOPICS[2]))
        self.assertEqual(status, 1, out)

    def test_what_changes_a_run_begins_another(self):
        settings = Settings(NODE, timeout=LIMIT)
        recorder = Recorder(self.path, NODE, TOPICS)
        self.assertTrue(self.client.call_reset().success)
        self.assertTrue(self.client.poke('head', (60, 20, 0), duration=2).success)
        self.go(30)
        kept = self.client.call_get().snapshot
        self.push(3)
        settings.update_configuration({'gravity_x': 1.5, 'step': 0.002})
        self.push(3)
        self.assertTrue(self.restore(kept).success)
        self.go(60)
        self.client.load(yaml=HANGING)
        self.go(60)
        self.assertTrue(self.client.service('detach', Detach)('right_hand').success)
        self.go(60)
        recorder.stop()
        status, out, errors = replay(self.path)
        self.assertEqual((status, errors), (0, ''), out)
        # as recorded, reset, other settings, restored, loaded, let go
        self.assertGreaterEqual(out.count('identical'), 5, out)

    def test_a_recording_may_end_while_a_wrench_acts(self):
        recorder = Recorder(self.path, NODE, TOPICS)
        self.assertTrue(self.client.call_reset().success)
        self.push(10)
        self.go(60)
        recorder.stop()
        status, out, errors = replay(self.path)
        self.assertEqual((status, errors), (0, ''), out)
        self.assertIn('identical', out)
        self.assertIn('not compared', out)

        # A bag of which nothing can be compared is not one that is identical.
        def untold(topic, message):
            if topic == TOPICS[1]:
                message.told = 0
                return message.step > 0
            return True
        status, out, errors = replay(self.altered(untold))
        last = [line for line in out.splitlines() if ' run ' in line][-1]
        self.assertEqual((status, errors), (2, ''), out)
        self.assertRegex(last, 'cannot be replayed: none of its [0-9]+ states can be compared')

    def test_what_follows_frames_of_others_is_identical(self):
        settings = Settings(NODE, timeout=LIMIT)
        attach, detach = (self.client.service(name, kind)
                          for name, kind in (('attach', Attach), ('detach', Detach)))
        robot = Robot(['paddle', 'hook'])
        self.addCleanup(robot.stop)
        heard = Inbox(NODE + '/followed', FollowedFrame)
        recorder = Recorder(self.path, NODE, TOPICS)
        self.client.load(yaml=PUSHED)
        self.go(100)
        self.assertTrue(self.client.call_reset().success)  # the frames have been heard before
        self.go(100)
        wait_for(lambda: attach('left_hand', 'hook').success, 'the frame')
        self.go(10)  # while the hand is still drawn to its frame
        kept = self.client.call_get().snapshot
        self.assertTrue(attach('right_foot', 'hook').success)
        run = self.client.call_get().state.run
        wait_for(lambda: len({m.step for m in heard.all() if (m.run, m.frame) == (run, 'hook')}) > 5,
                 'some of how the hook moves')
        self.go(100)
        settings.update_configuration({'gravity_x': 1.5, 'step': 0.002})
        self.go(100)
        self.assertTrue(self.client.call_pause(True).success)  # the frames go on
        rospy.rostime.wallsleep(0.2)
        self.assertTrue(self.client.call_pause(False).success)
        self.go(100)
        self.assertTrue(self.restore(kept).success)
        self.go(100)
        self.assertTrue(detach('left_hand').success)
        self.go(100)
        recorder.stop()
        status, out, errors = replay(self.path)
        self.assertEqual((status, errors), (0, ''), out)
        # loaded, reset, twice attached, other settings, restored, let go
        self.assertGreaterEqual(out.count('identical'), 7, out)

        followed = NODE + '/followed'
        with rosbag.Bag(self.path) as bag:
            told = [m for _, m, _ in bag.read_messages([followed])]
        self.assertEqual({m.frame for m in told}, {'paddle', 'hook'})
        status, out, _ = replay(self.altered(lambda topic, _: topic != followed))
        self.assertEqual(status, 2, out)
        self.assertIn('paddle, hook of another node, and ~followed was not recorded', out)
        hook = [m for m in told if (m.run, m.frame) == (run, 'hook')]
        # It holds hand and foot, and a step is made before the next one: two that come within one
        # tick begin at the same step, and the first leads nothing.
        led = next(m for m, after in zip(hook[2:], hook[3:]) if after.step > m.step)

        def changed(change):
            def alter(topic, m):
                return (topic != followed or (m.run, m.number) != (led.run, led.number) or change(m))
            return replay(self.altered(alter))
        status, out, _ = changed(lambda m: False)  # left out
        self.assertEqual(status, 2, out)
        self.assertIn('run %d: cannot be replayed' % led.run, out)
        self.assertIn('number %d is missing' % led.number, out)

        def nudge(message):
            message.goal.position.x += 1e-6
            return True
        status, out, _ = changed(nudge)
        self.assertEqual(status, 1, out)
        self.assertIn('run %d: differs at step' % led.run, out)

        def endless(message):
            message.duration = float('nan')
            return True
        status, _, errors = changed(endless)
        self.assertEqual(status, 2)
        self.assertIn('duration', errors)

    def test_a_bag_of_before_models_had_a_mass(self):
        """Such a bag replays as it is, and rosbag brings it up to date."""
        self.record_pokes()
        old_text = Model._full_text.replace('float64 mass  ', '#')
        types = genpy.dynamic.generate_dynamic('ragdoll_msgs/Model', old_text)
        Old, OldBody = types['ragdoll_msgs/Model'], types['ragdoll_msgs/RagdollModel']
        self.assertEqual(Old._md5sum, '90718b455b603a4402841136096aae23')
        old = os.path.join(self.folder, 'old.bag')
        with rosbag.Bag(self.path) as bag, rosbag.Bag(old, 'w') as out:
            for topic, message, stamp in bag.read_messages():
                if topic == TOPICS[0]:
                    bodies = [OldBody(r.name, r.particles, r.masses, r.sticks, r.joints)
                              for r in message.ragdolls]
                    message = Old(message.header, bodies, message.scene_yaml, message.scene,
                                  message.run, message.snapshot)
                out.write(topic, message, stamp)
        status, out, errors = replay(old)
        self.assertEqual(status, 0, errors)
        self.assertIn('identical', out)
        new = os.path.join(self.folder, 'new.bag')
        # Named, as rosbag finds it by itself only where rosdep has been set up.
        rule = os.path.join(roslib.packages.get_pkg_dir('ragdoll_sim'), 'migration',
                            'model_mass.bmr')
        fix = subprocess.run(['rosbag', 'fix', old, new, rule], stdout=subprocess.PIPE,
                             stderr=subprocess.STDOUT, timeout=LIMIT, universal_newlines=True)
        self.assertEqual(fix.returncode, 0, fix.stdout)
        with rosbag.Bag(new) as bag:
            told = [m for _, m, _ in bag.read_messages(TOPICS[:1])]
        self.assertEqual({m._md5sum for m in told}, {Model._md5sum})

    def test_what_cannot_be_read_is_named(self):
        self.record_pokes()
        text = os.path.join(self.folder, 'text.bag')
        with open(text, 'w') as file:
            file.write('not a bag')
        strange = os.path.join(self.folder, 'strange.bag')
        with rosbag.Bag(strange, 'w') as bag:
            bag.write('/chatter', String('hello'))

        def nonsense(topic, message):
            if topic == TOPICS[0]:
                message.scene_yaml = 'ragdolls: [{model: nobody}]'
        def damaged(topic, message):
            message.run = 7
            if topic == TOPICS[0]:
                message.snapshot = b'no snapshot'

        def of_nobody(topic, message):
            if topic == TOPICS[2]:
                message.body_name = message.body_name and 'tail'
        cases = [(os.path.join(self.folder, 'nowhere.bag'), ['nowhere.bag']),
                 (self.folder, [self.folder]), (text, ['text.bag']),
                 (strange, ['Model', '~model']),
                 (lambda topic, _: topic != TOPICS[0], ['ragdoll_msgs/Model', '~model']),
                 (lambda topic, _: topic != TOPICS[1], ['ragdoll_msgs/State', '~state']),
                 (nonsense, ['nobody']), (damaged, ['snapshot']), (of_nobody, ['tail', 'left_hand'])]
        for case, words in cases:
            status, out, errors = replay(self.altered(case) if callable(case) else case)
            self.assertEqual(status, 2, (out, errors))
            for word in words:
                self.assertIn(word, errors)


if __name__ == '__main__':
    rospy.init_node('lab_replay_test')
    rostest.rosrun('ragdoll_sim', 'lab_replay', LabReplayTest, sys.argv)
