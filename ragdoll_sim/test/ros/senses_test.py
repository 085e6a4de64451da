#!/usr/bin/python3
"""Sensors and forces as another node hears them: a plate of 4 kg at rest on a floor, one that falls, and one that
hangs."""

import sys
import unittest

import rospy
import rostest
import tf2_ros
from client import LIMIT, Client, Inbox, wait_for
from geometry_msgs.msg import TransformStamped, WrenchStamped
from ragdoll_msgs.msg import ContactStates, Impact
from sensor_msgs.msg import Imu

G = 9.81
MODEL = '''
      particles: {a: {position: [0.5, 0, 0], mass: 1, radius: 0.1}, b: {position: [-0.5, 0, 0], mass: 1, radius: 0.1},
                  c: {position: [0, 0.5, 0], mass: 1, radius: 0.1}, d: {position: [0, -0.5, 0], mass: 1, radius: 0.1}}
      sticks: [[a, b], [a, c], [a, d], [b, c], [b, d], [c, d]]
      segments: {plate: {particles: [a, b, c, d]}}
'''
SCENE = '''
ragdolls:
  - name: %s
    position: [0, 0, %g]
    model:''' + MODEL + '''
obstacles: [{name: floor, type: plane}]
sensors: [{name: box, type: imu, segment: plate, position: [0.1, 0, 0.2], rpy_deg: [90, 0, 0], rate: 40}]
solver: {sleep: false}
%s
'''
BALL = '''
  - name: %s
    position: %s
    model: {particles: {p: {position: [0, 0, 0], mass: %g, radius: 0.1}}}
'''


def xyz(v):
    return v.x, v.y, v.z


class SensesTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.client = Client()

    def load(self, *values):
        answer = self.client.call_load(yaml=SCENE % values)
        self.assertTrue(answer.success, answer.status_message)

    def test_imu(self):
        self.load('ben', 0.1, '')
        box = Inbox('/ragdoll/imu/ben/box', Imu)
        resting = box.first(lambda m: abs(m.linear_acceleration.y - G) < 1e-6, 'g')
        self.assertEqual(resting.header.frame_id, 'ben/box')
        self.assertAlmostEqual(resting.linear_acceleration.x, 0, 6)
        self.assertAlmostEqual(resting.orientation.x, 0.5 ** 0.5, 6)
        box.first(lambda m: (m.header.stamp - resting.header.stamp).to_sec() > 1, 'a second')
        stamps = [m.header.stamp.to_sec() for m in box.all()]
        self.assertGreater(len([s for s in stamps if s < stamps[0] + 1]), 35)
        buffer = tf2_ros.Buffer()
        listener = tf2_ros.TransformListener(buffer)
        self.addCleanup(listener.unregister)
        there = buffer.lookup_transform('world', 'ben/box', rospy.Time(), rospy.Duration(LIMIT))
        self.assertAlmostEqual(there.transform.translation.x, 0.1, 6)
        self.assertAlmostEqual(there.transform.translation.z, 0.3, 4)

    def test_contacts_and_wrench_carry_the_weight(self):
        self.load('ben', 0.1, '')
        contacts = Inbox('/ragdoll/contacts', ContactStates)
        told = contacts.first(lambda m: len(m.contacts) >= 3 and
                              abs(sum(c.force.z for c in m.contacts) - 4 * G) < 1e-6, 'the weight')
        self.assertEqual({c.other for c in told.contacts}, {'floor'})
        self.assertEqual({c.ragdoll for c in told.contacts}, {'ben'})
        floor = Inbox('/ragdoll/wrenches/floor', WrenchStamped)
        told = floor.first(lambda m: abs(m.wrench.force.z + 4 * G) < 1e-6, 'the weight')
        self.assertEqual(told.header.frame_id, 'world')
        self.assertLess(abs(told.wrench.torque.x) + abs(told.wrench.torque.y), 1e-3)

    def load_balls(self, balls, *rest):
        """Each a name, a place [m] and a mass [kg]."""
        yaml = '\n'.join(['ragdolls:' + ''.join(BALL % ball for ball in balls)] + list(rest))
        answer = self.client.call_load(yaml=yaml)
        self.assertTrue(answer.success, answer.status_message)

    def test_largest_contact_is_of_the_heavier_ball(self):
        largest = Inbox('/ragdoll/largest_contact', ContactStates)
        self.load_balls([('al', [0, 0, 0.1], 1), ('ben', [1, 0, 0.1], 3), ('eva', [2, 0, 0.1], 2)],
                        'obstacles: [{name: floor, type: plane}]')
        told = largest.first(lambda m: m.contacts and abs(m.contacts[0].force.z - 3 * G) < 1e-3,
                             'the weight of three')
        self.assertEqual((told.contacts[0].ragdoll, told.contacts[0].other), ('ben', 'floor'))
        self.assertAlmostEqual(told.contacts[0].impulse, 3 * G * told.interval, 2)
        largest.first(lambda m: (m.header.stamp - told.header.stamp).to_sec() > 2, 'two seconds')
        later = [m for m in largest.all() if m.header.stamp > told.header.stamp]
        self.assertTrue(all(len(m.contacts) == 1 for m in later))
        self.assertTrue(all(m.interval > 0.2 for m in later), [m.interval for m in later])
        self.load_balls([('al', [0, 0, 100], 1)])
        largest.first(lambda m: not m.contacts, 'a message of nothing')

    def test_names_that_are_the_same_as_topics_are_told_apart(self):
        self.load_balls([('al', [0, 0, 0.1], 4)], 'obstacles:',
                        ' - {name: wall-1, type: box, size: [1, 1, 1], position: [50, 0, 0]}',
                        ' - {name: wall.1, type: plane}')
        for topic, force in (('wall_1', 0), ('wall_1_2', -4 * G)):
            Inbox('/ragdoll/wrenches/' + topic, WrenchStamped).first(
                lambda m: abs(m.wrench.force.z - force) < 1e-3, topic)

    def check_wrench(self, topic, frame, force, torque):
        def near(a, b):
            return all(abs(x - y) < 0.02 * G for x, y in zip(xyz(a), b))
        told = Inbox('/ragdoll/wrenches/' + topic, WrenchStamped).first(
            lambda m: near(m.wrench.force, force) and near(m.wrench.torque, torque),
            'the wrench on ' + topic)
        self.assertEqual(told.header.frame_id, frame)

    def test_torque_is_about_the_origin_of_the_world(self):
        self.load_balls([('al', [2, 1, 0.1], 4), ('ben', [-3, 2, 5], 1)],
                        'obstacles: [{name: floor, type: plane}]',
                        'pins: [ben/p]')
        self.check_wrench('floor', 'world', (0, 0, -4 * G), (-4 * G, 8 * G, 0))
        self.check_wrench('pin_ben_p', 'world', (0, 0, -G), (-2 * G, -3 * G, 0))

    def test_torque_is_about_the_frame_that_an_obstacle_follows_and_in_its_axes(self):
        palm = TransformStamped()
        palm.header.frame_id, palm.child_frame_id = 'world', 'palm'
        at, turn = palm.transform.translation, palm.transform.rotation
        at.x, at.y, at.z = 1, 2, 0.5
        turn.x = turn.w = 0.5 ** 0.5  # its y is up, its z to the right
        broadcaster = tf2_ros.StaticTransformBroadcaster()
        broadcaster.sendTransform(palm)
        wait_for(lambda: broadcaster.pub_tf.get_num_connections() > 0, 'the node')
        self.load_balls([('al', [1.3, 2.2, 1], 4)],  # which falls onto it
                        'obstacles:',
                        ' - {name: table, type: box, size: [2, 2, 0.1], frame: palm,',
                        '    position: [0.2, -0.3, 0.1], rpy_deg: [90, 0, 0]}')
        self.check_wrench('table', 'palm', (0, -4 * G, 0), (-0.8 * G, 0, -1.2 * G))

    def test_pin_carries_the_body(self):
        self.load('eva', 2, 'pins: [a, b]')
        for name in ('pin_a', 'pin_b'):
            pin = Inbox('/ragdoll/wrenches/' + name, WrenchStamped)
            told = pin.first(lambda m: abs(m.wrench.force.z + 2 * G) < 0.05, 'half the weight')
            self.assertEqual(told.header.frame_id, 'world')

    def test_impact_begins_and_ends(self):
        self.load('ben', 0.6, '')
        self.client.call_pause(True)
        self.client.call_reset()
        impacts = Inbox('/ragdoll/impacts', Impact)
        self.client.call_pause(False)
        began = impacts.first(lambda m: not m.over, 'an impact')
        self.assertEqual((began.region, began.other), ('plate', 'floor'))
        self.assertAlmostEqual(began.approach_speed, (2 * G * 0.5) ** 0.5, 1)
        self.assertGreater(began.effective_mass, 0.9)

        def ids(over):
            return {m.id for m in impacts.all() if m.over == over}
        impacts.first(lambda m: m.over and m.id == began.id, 'its end')
        wait_for(lambda: ids(True) == ids(False), 'the ends of all')
        ends = [m for m in impacts.all() if m.over]
        duration = max(m.duration for m in ends)
        self.assertAlmostEqual(duration, 0.1, delta=0.02)
        # Together they stopped the plate and carried it since.
        self.assertAlmostEqual(sum(m.impulse for m in ends), 4 * began.approach_speed + 4 * G * duration, delta=0.5)
        for end in ends:
            self.assertGreater(end.peak_force, end.impulse / end.duration)


if __name__ == '__main__':
    rospy.init_node('senses_test')
    rostest.rosrun('ragdoll_sim', 'senses_test', SensesTest, sys.argv)
