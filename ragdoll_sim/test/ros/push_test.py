#!/usr/bin/python3
"""push.launch: the gripper pushes the body along the floor, and drags it back by its hand."""

import sys
import unittest

import rospy
import rostest
import tf2_ros
from client import Client, position, wait_for


class PushTest(unittest.TestCase):
    def setUp(self):
        self.client = Client()
        self.frames = tf2_ros.Buffer()
        tf2_ros.TransformListener(self.frames)

    def x(self):
        """[m] of the body's middle."""
        xs = [p.x for p in self.client.states.all()[-1].ragdolls[0].positions]
        return sum(xs) / len(xs)

    def height_of_hand(self):
        return position(self.client.model, self.client.states.all()[-1], 'right_hand')[2]

    def fingers(self):
        t = self.frames.lookup_transform('world', 'gripper/fingers', rospy.Time(0)).transform
        return (t.translation.x, t.translation.y, t.translation.z)

    def held(self):
        hand = position(self.client.model, self.client.states.all()[-1], 'right_hand')
        return all(abs(a - b) < 0.1 for a, b in zip(hand, self.fingers()))

    def test_the_body_is_pushed_and_dragged(self):
        run = self.client.call_get().state.run
        wait_for(lambda: self.client.states.all()[-1].run > run or
                 self.client.states.all()[-1].step < 60, 'a round')
        wait_for(lambda: abs(self.x()) < 0.1, 'the body at its start')
        wait_for(lambda: self.x() > 0.4, 'a body that was pushed')
        wait_for(lambda: self.height_of_hand() > 0.8 and self.held(), 'a hand that is held up')
        wait_for(lambda: self.x() < 0, 'a body that was dragged back')
        wait_for(lambda: self.height_of_hand() < 0.3, 'a hand that was let go')


if __name__ == '__main__':
    rospy.init_node('push_demo_test')
    rostest.rosrun('ragdoll_sim', 'push_demo', PushTest, sys.argv)
