#!/usr/bin/python3
"""~wrench, and ~pokes played into ~poke_replay: the same bits again."""

import sys
import unittest

import rospy
import rostest
from client import Client, bits, momentum, wait_for
from geometry_msgs.msg import WrenchStamped
from ragdoll_msgs.msg import PokeEvent

TIMEOUT = 0.2  # [s] ~wrench_timeout


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

    def events_after(self, seen, count):
        return wait_for(lambda: len(self.client.pokes.all()) >= seen + count and
                        self.client.pokes.all()[seen:], '%d poke events' % count)

    def push(self, frame, force, torque=(0, 0, 0)):
        message = WrenchStamped()
        message.header.frame_id = frame
        w = message.wrench
        w.force.x, w.force.y, w.force.z = force
        w.torque.x, w.torque.y, w.torque.z = torque
        self.wrench.publish(message)

    def pushed_state(self, frame, force, steps, torque=(0, 0, 0)):
        """The state some steps after a wrench, once the node has heard of it."""
        self.push(frame, force, torque)

        def heard():
            # Nothing tells that a wrench has come but what it does: try, and begin again if not.
            kept = self.client.call_step(1)
            assert kept.success
            state = self.client.at(kept.step)
            if any(abs(p) > 1e-9 for p in self.gained(state)) or self.turned(state):
                return state
            self.client.restart()
            self.push(frame, force, torque)  # a reset ends what came just before it
            return None
        wait_for(heard, 'the wrench')
        return self.client.step(steps - 1)

    def turned(self, state):
        return any(abs(a.x - b.x) > 1e-4 for a, b in zip(
            state.ragdolls[0].velocities, self.free_velocities))

    def gained(self, state):
        before, after = momentum(self.client.model, self.start), momentum(self.client.model, state)
        return [a - b for a, b in zip(after, before)]

    def assert_vector(self, got, expected, tolerance=1e-9):
        for a, b in zip(got, expected):
            self.assertAlmostEqual(a, b, delta=tolerance, msg='%s, not %s' % (got, expected))

    def test_a_wrench_ends_by_itself(self):
        self.free_velocities = self.client.step(1).ragdolls[0].velocities
        self.client.restart()
        n = int(round(TIMEOUT / self.h))
        # The frame of a particle is aligned with the world at the start.
        state = self.pushed_state('ragdoll/left_hand', (10, 0, 0), 2 * n)
        self.assert_vector(self.gained(state), [10 * n * self.h, 0, 0], 1e-8)

    def test_on_the_pelvis_the_hips_share_it(self):
        self.free_velocities = self.client.step(1).ragdolls[0].velocities
        free = self.client.at(1)
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
        self.free_velocities = free.ragdolls[0].velocities
        self.client.restart()
        state = self.pushed_state('ragdoll/left_elbow', (0, 0, 0), 1, torque=(0, 20, 0))
        self.assert_vector(self.gained(state), [0, 0, 0], 1e-9)
        i = self.client.model.ragdolls[0].particles.index('left_hand')
        gain = state.ragdolls[0].velocities[i].x - free.ragdolls[0].velocities[i].x
        self.assertLess(gain, 0)  # about +y what is below moves towards -x

    def test_recorded_pokes_give_the_same_bits(self):
        self.client.step(20)
        seen = len(self.client.pokes.all())
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
        events = self.events_after(seen, 5)
        self.assertEqual(sorted(e.body_name for e in events),
                         ['', 'ragdoll/head', 'ragdoll/left_foot', 'ragdoll/right_forearm',
                          'ragdoll/torso'])
        self.client.restart()
        seen = len(self.client.pokes.all())
        for event in events:
            self.replay.publish(event)
        self.events_after(seen, 5)
        self.assertEqual(bits(self.client.step(220)), bits(expected))

    def test_what_is_past_is_not_replayed(self):
        free = bits(self.client.step(50))
        self.client.restart()
        self.client.step(30)
        event = PokeEvent(step=10, body_name='ragdoll/head', duration=rospy.Duration(1))
        event.force.x = 1000
        self.replay.publish(event)
        event.step = 1000000  # accepted, so that it is known that the first has been heard
        seen = len(self.client.pokes.all())
        self.replay.publish(event)
        self.events_after(seen, 1)
        self.assertEqual(bits(self.client.step(20)), free)


if __name__ == '__main__':
    rospy.init_node('replay_test')
    rostest.rosrun('ragdoll_sim', 'replay', ReplayTest, sys.argv)
