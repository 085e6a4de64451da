#!/usr/bin/python3
"""~wrench, and ~pokes played into ~poke_replay: the same bits again."""

import sys
import unittest

import rospy
import rostest
from client import Client, Inbox, bits, momentum, wait_for
from geometry_msgs.msg import WrenchStamped
from ragdoll_msgs.msg import PokeEvent
from rosgraph_msgs.msg import Log

TIMEOUT = 0.2  # [s] ~wrench_timeout
WEIGHTLESS = 'package://ragdoll_sim/test/ros/weightless.yaml'
TURNED = '''
gravity: [0, 0, 0]
ragdolls:
  - {name: ragdoll, model: human_lumped, position: [0, 0, 1.5], rpy_deg: [0, 0, 90]}
'''


class ReplayTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.client = Client()
        cls.replay = rospy.Publisher('/ragdoll/poke_replay', PokeEvent, queue_size=100)
        cls.wrench = rospy.Publisher('/ragdoll/wrench', WrenchStamped, queue_size=100)
        for publisher in (cls.replay, cls.wrench):
            wait_for(lambda p=publisher: p.get_num_connections() > 0, 'the node')

    def setUp(self):
        self.client.restart()
        self.client.call_clear()
        self.h = self.client.step(1).time
        self.start = self.client.restart()

    def publish(self, frame, force, torque=(0, 0, 0)):
        message = WrenchStamped()
        message.header.frame_id = frame
        w = message.wrench
        w.force.x, w.force.y, w.force.z = force
        w.torque.x, w.torque.y, w.torque.z = torque
        self.wrench.publish(message)

    def push(self, frame, force, torque=(0, 0, 0)):
        """A wrench that is not refused."""
        before = self.client.call_get().snapshot
        self.publish(frame, force, torque)
        # What acts is part of the snapshot.
        wait_for(lambda: self.client.call_get().snapshot != before, 'the wrench')

    def pushed_state(self, frame, force, steps, torque=(0, 0, 0)):
        """The state some steps after a wrench."""
        self.push(frame, force, torque)
        return self.client.step(steps)

    def gained(self, state):
        before, after = momentum(self.client.model, self.start), momentum(self.client.model, state)
        return [a - b for a, b in zip(after, before)]

    def assert_vector(self, got, expected, tolerance=1e-9):
        for a, b in zip(got, expected):
            self.assertAlmostEqual(a, b, delta=tolerance, msg='%s, not %s' % (got, expected))

    def test_a_wrench_ends_by_itself(self):
        n = int(round(TIMEOUT / self.h))
        # The frame of a particle is aligned with the world at the start.
        state = self.pushed_state('ragdoll/left_hand', (10, 0, 0), 2 * n)
        self.assert_vector(self.gained(state), [10 * n * self.h, 0, 0], 1e-8)

    def test_on_the_pelvis_the_hips_share_it(self):
        free = self.client.step(1)
        self.client.restart()
        state = self.pushed_state('ragdoll/pelvis', (0, 0, 50), 1)
        self.assert_vector(self.gained(state), [0, 0, 50 * self.h], 1e-8)
        particles = self.client.model.ragdolls[0].particles
        gains = {p: state.ragdolls[0].velocities[i].z - free.ragdolls[0].velocities[i].z
                 for i, p in enumerate(particles)}
        self.assertGreater(min(gains['left_hip'], gains['right_hip']),
                           max(gains['left_knee'], gains['head']))

    def test_a_torque_turns_without_pushing(self):
        free = self.client.step(1)
        self.client.restart()
        state = self.pushed_state('ragdoll/left_elbow', (0, 0, 0), 1, torque=(0, 20, 0))
        self.assert_vector(self.gained(state), [0, 0, 0], 1e-9)
        i = self.client.model.ragdolls[0].particles.index('left_hand')
        gain = state.ragdolls[0].velocities[i].x - free.ragdolls[0].velocities[i].x
        self.assertLess(gain, 0)  # about +y what is below moves towards -x

    def test_it_acts_in_its_frame_however_that_is_turned(self):
        self.client.load(yaml=TURNED)
        self.addCleanup(self.client.load, path=WEIGHTLESS)
        self.setUp()
        n = 10
        # A quarter turn about z: the frame's x axis is the world's y, its y axis the world's -x.
        state = self.pushed_state('ragdoll/left_hand', (10, 20, 30), n)
        self.assert_vector(self.gained(state),
                           [c * n * self.h for c in (-20, 10, 30)], 1e-8 + 0.01 * 30 * n * self.h)
        self.client.restart()
        free = self.client.step(1)
        self.client.restart()
        state = self.pushed_state('ragdoll/left_elbow', (0, 0, 0), 1, torque=(0, 20, 0))
        i = self.client.model.ragdolls[0].particles.index('left_hand')
        gain = [getattr(state.ragdolls[0].velocities[i], axis) -
                getattr(free.ragdolls[0].velocities[i], axis) for axis in 'xyz']
        self.assertLess(gain[1], 0)  # about -x what is below moves towards -y
        self.assertLess(abs(gain[0]), 0.05 * abs(gain[1]))

    def test_recorded_pokes_give_the_same_bits(self):
        self.client.step(20)
        seen = len(self.client.told())
        self.client.poke('head', (40, 10, 0), duration=0.5)
        self.client.step(10)
        self.client.poke('right_forearm', (0, 60, 0), frame='ragdoll/head', duration=-1)
        self.push('ragdoll/left_foot', (0, 0, 80))
        self.client.step(100)
        self.client.call_clear()
        self.client.poke('torso', (0, 0, 100), point=(0.1, 0.2, 0), duration=0.25)
        self.client.step(90)
        expected = self.client.at(220)
        # head, forearm, the wrench (when it has ended), the clearing, the torso
        events = self.client.told()[seen:]
        self.assertEqual(sorted(e.body_name for e in events),
                         ['', 'ragdoll/head', 'ragdoll/left_foot', 'ragdoll/right_forearm',
                          'ragdoll/torso'])
        self.client.restart()
        seen = len(self.client.told())
        for event in events:
            self.replay.publish(event)
        wait_for(lambda: len(self.client.told()) == seen + len(events), 'the pokes')
        self.assertEqual(bits(self.client.step(220)), bits(expected))

    def test_what_is_past_is_not_replayed(self):
        free = bits(self.client.step(50))
        self.client.restart()
        self.client.step(30)
        event = PokeEvent(step=10, body_name='ragdoll/head', duration=rospy.Duration(1))
        event.force.x = 1000
        self.replay.publish(event)
        event.step = 1000000  # accepted, so that it is known that the first has been heard
        self.replay.publish(event)
        wait_for(lambda: [e for e in self.client.told() if e.step == event.step], 'the poke')
        self.assertEqual(bits(self.client.step(20)), free)

    def test_a_force_that_no_step_can_follow_is_refused_with_the_largest_that_is_allowed(self):
        free = bits(self.client.step(20))
        self.client.restart()
        log = Inbox('/rosout', Log)
        event = PokeEvent(step=5, body_name='ragdoll/head')
        event.force.x = 1e20
        for topic, send in (('~wrench', lambda: self.publish('ragdoll/left_hand', (0, 0, 1e20))),
                            ('~poke_replay', lambda: self.replay.publish(event))):
            def refused(topic=topic, send=send):
                send()  # again and again: the log may not be connected yet, and is throttled
                return [m.msg for m in log.all()
                        if m.msg.startswith(topic + ' ignored') and '1e+20' in m.msg]
            text = wait_for(refused, 'a warning')[0]
            self.assertIn('ragdoll/', text)
            self.assertRegex(text, r'at most \d.*e\+\d+ N')
        self.assertEqual(bits(self.client.step(20)), free)


if __name__ == '__main__':
    rospy.init_node('replay_test')
    rostest.rosrun('ragdoll_sim', 'replay', ReplayTest, sys.argv)
