#!/usr/bin/python3
"""Pokes, as another node would give them. Weightless, so that momentum knows the answer."""

import math
import sys
import unittest

import rospy
import rostest
import tf2_ros
from client import LIMIT, Client, bits, momentum, position, velocity, wait_for
from geometry_msgs.msg import TransformStamped, Vector3

FORCE = 30.0    # [N]
SECONDS = 0.1   # [s]


def static(parent, child, position, yaw):
    t = TransformStamped()
    t.header.frame_id, t.child_frame_id = parent, child
    t.transform.translation = Vector3(*position)
    t.transform.rotation.z, t.transform.rotation.w = math.sin(yaw / 2), math.cos(yaw / 2)
    return t


def rotated(q, v):
    """v turned by the quaternion message q."""
    def cross(a, b):
        return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    u = [q.x, q.y, q.z]
    t = [2 * c for c in cross(u, v)]
    return [a + q.w * b + c for a, b, c in zip(v, t, cross(u, t))]


class PokeTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.client = Client()
        cls.buffer = tf2_ros.Buffer()
        cls.listener = tf2_ros.TransformListener(cls.buffer)
        # The tool's x axis points along the world's y; TF has heard of the island, but it does not
        # hang together with the world.
        cls.broadcaster = tf2_ros.StaticTransformBroadcaster()
        cls.broadcaster.sendTransform([static('world', 'tool', (1, 2, 3), math.pi / 2),
                                       static('another_world', 'island', (0, 0, 0), 0)])

    def setUp(self):
        self.client.restart()
        self.h = self.client.step(1).time
        self.start = self.client.restart()

    def steps(self, seconds):
        return int(round(seconds / self.h))

    def gained(self, state):
        before, after = momentum(self.client.model, self.start), momentum(self.client.model, state)
        return [a - b for a, b in zip(after, before)]

    def accept(self, *args, **kwargs):
        answer = self.client.poke(*args, **kwargs)
        self.assertTrue(answer.success, answer.status_message)

    def assert_vector(self, got, expected, tolerance=1e-9):
        for a, b in zip(got, expected):
            self.assertAlmostEqual(a, b, delta=tolerance, msg='%s, not %s' % (got, expected))

    def test_gives_the_impulse_of_force_times_time(self):
        self.accept('right_hand', (FORCE, 0, 0), duration=SECONDS)
        n = self.steps(SECONDS)
        self.assert_vector(self.gained(self.client.step(n)), [FORCE * n * self.h, 0, 0])
        self.assert_vector(self.gained(self.client.step(n)), [FORCE * n * self.h, 0, 0])

    def test_says_when_it_acts(self):
        n = self.steps(SECONDS)
        cases = [({'duration': SECONDS}, 'from step 0 for %d steps' % n),
                 ({'duration': 0}, 'from step 0 for 1 step'),
                 ({'duration': 1e-9}, 'from step 0 for 1 step'),
                 ({'duration': -1}, 'from step 0 until cleared'),
                 ({'start': 2 ** 32 - 1}, 'for 1 step')]  # farther than a ros::Duration reaches
        for kwargs, end in cases:
            answer = self.client.poke('head', (1, 0, 0), **kwargs)
            self.assertTrue(answer.success, answer.status_message)
            self.assertTrue(answer.status_message.endswith(end), answer.status_message)
        told = int(answer.status_message.split('from step ')[1].split()[0])
        self.assertAlmostEqual(told * self.h, 2 ** 32 - 1 - rospy.Time.now().to_sec(), delta=LIMIT)

    def test_moves_the_named_body(self):
        free = self.client.step(5)
        self.client.restart()
        self.accept('ragdoll/right_hand', (0, FORCE, 0), duration=1.0)
        poked = self.client.step(5)

        def moved(particle):
            a, b = (position(self.client.model, s, particle) for s in (poked, free))
            return sum((x - y) ** 2 for x, y in zip(a, b)) ** 0.5
        hand = moved('right_hand')
        others = [p for p in self.client.model.ragdolls[0].particles if p != 'right_hand']
        self.assertGreater(hand, 2 * max(moved(p) for p in others))

    def test_takes_a_bone_and_tells_the_poke(self):
        seen = len(self.client.told())
        self.accept('right_forearm', (0, 0, FORCE), duration=SECONDS)
        event = self.client.told()[seen]
        self.assertEqual(event.body_name, 'ragdoll/right_forearm')
        self.assertEqual((event.step, event.force.z), (0, FORCE))
        n = self.steps(SECONDS)
        self.assertEqual(int(round(event.duration.to_sec() / self.h)), n)
        self.assert_vector(self.gained(self.client.step(n)), [0, 0, FORCE * n * self.h])

    def test_turns_the_force_from_a_frame_of_tf(self):
        wait_for(lambda: self.client.poke('head', (FORCE, 0, 0), frame='tool').success,
                 'a poke in the frame tool')
        self.assert_vector(self.gained(self.client.step(1)), [0, FORCE * self.h, 0])

    def test_turns_the_force_from_one_of_its_own_frames_at_this_very_step(self):
        before = self.client.step(self.steps(0.5))
        self.accept('torso', (FORCE, 0, 0), frame='ragdoll/head')
        now = wait_for(lambda: self.transform_after('ragdoll/head', before.header.stamp),
                       'the head in TF')
        expected = rotated(now.transform.rotation, [FORCE * self.h, 0, 0])
        after = momentum(self.client.model, self.client.step(1))
        got = [a - b for a, b in zip(after, momentum(self.client.model, before))]
        self.assert_vector(got, expected, 1e-6)
        self.assertLess(abs(got[0]), 0.99 * FORCE * self.h)  # the head has turned

    def transform_after(self, frame, stamp):
        try:
            t = self.buffer.lookup_transform('world', frame, rospy.Time(0))
        except tf2_ros.TransformException:
            return None
        return t if t.header.stamp > stamp else None

    def test_an_offset_turns_the_bone(self):
        # Pushed at one end, a bone gains more speed there than at the other.
        free = self.client.step(1)
        self.client.restart()
        hand, elbow = (position(self.client.model, self.start, p)
                       for p in ('left_hand', 'left_elbow'))
        self.accept('left_forearm', (10 * FORCE, 0, 0),
                    point=[(a - b) / 2 for a, b in zip(hand, elbow)])
        poked = self.client.step(1)

        def gain(particle):
            return (velocity(self.client.model, poked, particle)[0] -
                    velocity(self.client.model, free, particle)[0])
        self.assertGreater(gain('left_hand'), 0)
        self.assertGreater(gain('left_hand'), 3 * gain('left_elbow'))

    def test_no_duration_is_one_step(self):
        self.accept('head', (FORCE, 0, 0), duration=0)
        self.assert_vector(self.gained(self.client.step(10)), [FORCE * self.h, 0, 0])

    def test_negative_duration_lasts_until_cleared(self):
        self.accept('head', (FORCE, 0, 0), duration=-1)
        n = self.steps(3.0)
        self.assert_vector(self.gained(self.client.step(n)), [FORCE * n * self.h, 0, 0], 1e-7)
        self.assertTrue(self.client.call_clear().success)
        self.assert_vector(self.gained(self.client.step(100)), [FORCE * n * self.h, 0, 0], 1e-7)

    def test_start_in_the_past_is_now(self):
        self.accept('head', (FORCE, 0, 0), start=1)
        self.assert_vector(self.gained(self.client.step(1)), [FORCE * self.h, 0, 0])

    def test_a_later_start_waits_for_its_step(self):
        seen = len(self.client.told())
        later = rospy.Time.now() + rospy.Duration(5.0)
        self.accept('head', (FORCE, 0, 0), start=later.to_sec(), duration=SECONDS)
        left = (later - rospy.Time.now()).to_sec()
        event = self.client.told()[seen]
        self.assertGreaterEqual(event.step, self.steps(left))
        self.assertLessEqual(event.step, self.steps(5.0))
        self.assert_vector(self.gained(self.client.step(event.step)), [0, 0, 0])
        n = self.steps(SECONDS)
        self.assert_vector(self.gained(self.client.step(n + 10)), [FORCE * n * self.h, 0, 0], 1e-7)

    def test_reset_ends_pokes(self):
        self.accept('head', (FORCE, 0, 0), duration=-1)
        self.client.restart()
        self.assert_vector(self.gained(self.client.step(20)), [0, 0, 0])

    def test_says_what_was_wrong_and_changes_nothing(self):
        nan, infinite = float('nan'), float('inf')
        cases = [
            (('rigth_hand', (1, 0, 0)), {}, ['rigth_hand', 'left_hand', 'right_hand', 'torso']),
            (('', (1, 0, 0)), {}, ['head', 'right_forearm']),
            (('nobody/head', (1, 0, 0)), {}, ['nobody', 'ragdoll']),
            (('head', (nan, 0, 0)), {}, ['force', 'finite']),
            (('head', (0, infinite, 0)), {}, ['force', 'finite']),
            (('head', (0, 0, -infinite)), {}, ['force', 'finite']),
            (('head', (1e20, 0, 0)), {}, ['force', '1e+20', 'ragdoll/head', 'at most']),
            (('head', (1, 0, 0)), {'point': (0, nan, 0)}, ['reference_point', 'finite']),
            (('head', (1, 0, 0)), {'frame': 'nowhere'}, ['nowhere', 'world', 'ragdoll/head']),
            (('head', (1, 0, 0)), {'frame': 'island'}, ['island', 'world']),
        ]
        wait_for(lambda: self.buffer.can_transform('another_world', 'island', rospy.Time(0)),
                 'the frame island')
        seen = len(self.client.told())
        for args, kwargs, words in cases:
            answer = self.client.poke(*args, duration=1.0, **kwargs)
            self.assertFalse(answer.success, args)
            for word in words:
                self.assertIn(word, answer.status_message)
        after = self.client.step(30)
        self.client.restart()
        self.assertEqual(bits(after), bits(self.client.step(30)))
        self.assertEqual(len(self.client.told()), seen)


if __name__ == '__main__':
    rospy.init_node('poke_test')
    rostest.rosrun('ragdoll_sim', 'poke', PokeTest, sys.argv)
