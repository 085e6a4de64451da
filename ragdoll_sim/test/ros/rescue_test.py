#!/usr/bin/python3
"""rescue.launch: the gripper drags the body by its hand over the floor and up the ramp, and feels it."""

import sys
import unittest

import rospy
import rostest
from client import Client, Inbox, wait_for
from geometry_msgs.msg import WrenchStamped


class RescueTest(unittest.TestCase):
    def test_the_body_is_dragged_up_the_ramp(self):
        client = Client()
        force = Inbox('/ragdoll/wrenches/attach_right_hand', WrenchStamped)

        def middle(axis):
            points = client.states.all()[-1].ragdolls[0].positions
            return sum(getattr(p, axis) for p in points) / len(points)
        dragged = force.first(lambda m: m.wrench.force.x < -30, 'a force against the way')
        self.assertEqual(dragged.header.frame_id, 'gripper')
        wait_for(lambda: middle('x') > 2, 'a body on its way')
        wait_for(lambda: middle('z') > 0.35, 'a body on the ramp')


if __name__ == '__main__':
    rospy.init_node('rescue_demo_test')
    rostest.rosrun('ragdoll_sim', 'rescue_demo', RescueTest, sys.argv)
