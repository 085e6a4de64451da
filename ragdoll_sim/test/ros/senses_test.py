#!/usr/bin/python3
"""Sensors and forces as another node hears them: a plate of 4 kg at rest on a floor, one that falls, and one that
hangs."""

import sys
import unittest

import rospy
import rostest
import tf2_ros
from client import LIMIT, Client, Inbox
from geometry_msgs.msg import WrenchStamped
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


if __name__ == '__main__':
    rospy.init_node('senses_test')
    rostest.rosrun('ragdoll_sim', 'senses_test', SensesTest, sys.argv)
