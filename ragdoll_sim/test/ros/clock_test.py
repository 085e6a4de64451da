#!/usr/bin/python3
"""~publish_clock: the simulation is the clock; ~realtime_factor: faster than real time."""

import sys
import time
import unittest

import rospy
import rostest
import tf2_ros
from client import Client, Inbox, start_node, wait_for
from diagnostic_msgs.msg import DiagnosticArray
from geometry_msgs.msg import TransformStamped
from page import column, of_node
from ragdoll_msgs.msg import FollowedFrame
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import Imu
from tf2_msgs.msg import TFMessage

SENSED = '''
ragdolls: [{name: ben, model: {sticks: [[a, b]], segments: {rod: {from: a, to: b}},
  particles: {a: {position: [0, 0, 1], mass: 1}, b: {position: [1, 0, 1], mass: 1}}}}]
sensors: [{name: box, type: imu, segment: rod, rate: 500}]
solver: {step: 0.001}
'''
PUSHED = '''
gravity: [0, 0, 0]
ragdolls:
  - {name: ball, model: {particles: {p: {position: [0, 0, 0], mass: 5, radius: 0.1}}}, position: [0, 0, 1]}
obstacles:
  - {type: box, frame: pusher, position: [0, 0, 0], size: [0.2, 1, 1]}
'''


class ClockTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.client = Client()
        cls.clock = Inbox('/clock', Clock)

    def setUp(self):
        self.client.restart()
        self.client.call_pause(False)
        wait_for(self.clock.all, 'the clock')

    def times(self):
        return [m.clock.to_nsec() for m in self.clock.all()]

    def test_ticks_forward_only_and_at_most_a_hundred_times_a_second(self):
        def seconds_of_hundred():
            seen, begin = len(self.times()), time.monotonic()
            wait_for(lambda: len(self.times()) >= seen + 50, 'the clock')
            self.assertTrue(self.client.call_reset().success)
            wait_for(lambda: len(self.times()) >= seen + 100, 'the clock after a reset')
            return time.monotonic() - begin
        # A busy machine delivers in bursts, now and then; it does not do so every time.
        wait_for(lambda: seconds_of_hundred() > 0.98, 'a hundred ticks in a second')
        times = self.times()
        self.assertGreater(times[0], 0)
        self.assertTrue(all(a < b for a, b in zip(times, times[1:])))

    def test_the_page_tells_who_has_the_clock(self):
        """docs/ros_api.md: with ~publish_clock it is published, else /use_sim_time follows it."""
        published, subscribed = of_node('/ragdoll')
        of_scene = {topic for topic in published if topic.startswith('/ragdoll/wrenches/')}
        self.assertEqual(set(column('Published topics')), published - of_scene)
        self.assertEqual(set(column('Subscribed topics')), subscribed)  # and does not follow itself
        self.assertEqual(column('Published topics')['/clock'], Clock._type)
        self.assertEqual(column('Subscribed topics')['/clock'], Clock._type)
        published, subscribed = of_node('/free')
        self.assertNotIn('/clock', published)
        self.assertIn('/clock', subscribed)

    def test_goes_five_times_as_fast(self):
        def factor():
            first, begin = self.times()[-1], time.monotonic()
            wait_for(lambda: self.times()[-1] > first + 5e9, 'five seconds')
            return (self.times()[-1] - first) * 1e-9 / (time.monotonic() - begin)
        # A busy machine delivers late, now and then; it does not do so every time.
        wait_for(lambda: abs(factor() - 5) < 0.25, 'five seconds in one')

    def test_stamps_are_of_this_clock_and_never_repeated(self):
        tf = Inbox('/tf', TFMessage)
        wait_for(lambda: len(tf.all()) > 100, 'transforms')
        stamps = [m.transforms[0].header.stamp.to_nsec() for m in tf.all()
                  if m.transforms[0].child_frame_id == 'ragdoll/pelvis' and
                  m._connection_header['callerid'] == '/ragdoll']
        self.assertTrue(all(a < b for a, b in zip(stamps, stamps[1:])))
        states = self.client.states.all()[-50:]
        for a, b in zip(states, states[1:]):
            if b.step > a.step:
                self.assertAlmostEqual((b.header.stamp - a.header.stamp).to_sec(), b.time - a.time,
                                       delta=1e-6)

    def test_samples_of_an_imu_are_stamped_by_this_clock(self):
        """500 Hz at five times the speed, across a reset and many steps at once; and in a node that runs
        free and follows the clock."""
        def stamps_of(client, node):
            self.assertTrue(client.call_load(yaml=SENSED).success)
            imu = Inbox(node + '/imu/ben/box', Imu)
            self.addCleanup(imu.subscriber.unregister)
            client.call_pause(False)
            wait_for(lambda: len(imu.all()) > 1000, 'samples')
            self.assertTrue(client.call_reset().success)
            seen = len(imu.all())
            wait_for(lambda: len(imu.all()) > seen + 500, 'samples after a reset')
            client.call_pause(True)
            client.call_step(500)
            seen = len(imu.all())
            client.call_step(500)
            wait_for(lambda: len(imu.all()) >= seen + 250, 'samples of steps at once')
            return [m.header.stamp.to_nsec() for m in imu.all()]

        for client, node in ((Client('/free'), '/free'), (self.client, '/ragdoll')):
            stamps = stamps_of(client, node)
            self.addCleanup(client.call_load, path='package://ragdoll_sim/scenes/fall.yaml')
            apart = [b - a for a, b in zip(stamps, stamps[1:])]
            self.assertGreaterEqual(min(apart), 0, node)
        # But where the reset cuts a sample short.
        self.assertLessEqual(sum(abs(d - 2000000) > 1000 for d in apart), 1)

    def test_stands_while_paused(self):
        self.client.call_pause(True)
        stopped = self.client.call_step(0).step
        self.client.at(stopped)
        wait_for(lambda: self.times()[-1] == max(self.times()), 'the last tick')
        time_of_stop = self.client.states.all()[-1].header.stamp.to_nsec()
        for _ in range(20):
            self.client.call_step(0)
        self.assertLessEqual(max(self.times()), time_of_stop)

    def test_a_frame_is_not_silent_while_the_clock_stands(self):
        """As in a paused Gazebo: neither ticks nor transforms."""
        follower = start_node(self, 'follower', tf_bodies='none')
        follower.load(yaml=PUSHED)
        reports = Inbox('/diagnostics', DiagnosticArray)
        followed = Inbox('/follower/followed', FollowedFrame)
        broadcaster = tf2_ros.TransformBroadcaster()

        def told():
            return [s for m in reports.all() for s in m.status if s.name.startswith('follower:')]

        def heard():
            t = TransformStamped()
            t.header.stamp = rospy.Time.now()
            t.header.frame_id, t.child_frame_id = 'world', 'pusher'
            t.transform.translation.x, t.transform.rotation.w = -2, 1
            broadcaster.sendTransform(t)
            return followed.all()
        wait_for(heard, 'the frame to be followed')
        self.client.call_pause(True)
        seen = len(told())
        wait_for(lambda: len(told()) >= seen + 4, 'reports of four seconds')
        self.assertEqual([s.message for s in told() if 'pusher' in s.message], [])
        self.client.call_pause(False)
        wait_for(lambda: any('no news from TF of pusher' in s.message for s in told()), 'silence')

    def test_runs_free(self):
        free = Client('/free')
        free.call_pause(False)

        def factor():
            first, begin = free.call_get().state.time, time.monotonic()
            wait_for(lambda: free.call_get().state.time > first + 5, 'five seconds')
            return (free.call_get().state.time - first) / (time.monotonic() - begin)
        # Measured about 100; a busy machine slows some of these stretches down, not all.
        wait_for(lambda: factor() > 5, 'a simulation faster than real time')
        free.call_pause(True)


if __name__ == '__main__':
    rospy.init_node('clock_test')
    rostest.rosrun('ragdoll_sim', 'clock', ClockTest, sys.argv)
