#!/usr/bin/python3
"""A gripper that takes the limp body's hand, drags the body over the floor and up a ramp, and lets go.

Broadcasts the TF frame `gripper`. The force on it is on ~wrenches/attach_<hand> of the node: plot it with
    rqt_plot /ragdoll/wrenches/attach_right_hand/wrench/force/x
Parameters: ~node (/ragdoll), ~hand (right_hand), ~speed (0.4 m/s), ~rounds (0: without end).
"""

import os
import sys

import rospy
from geometry_msgs.msg import WrenchStamped

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))  # run by catkin's relay, too
from gripper import Gripper, run  # noqa: E402

START = (0.0, 0.0, 1.5)         # [m]
LIFT = 0.5                      # [m] that the hand is held up while it is dragged
WAY = ((2.0, 0.0, 0.0), (5.4, 0.0, 0.65))   # [m] foot of the ramp, and up on it


class Rescuer(Gripper):
    def __init__(self):
        super().__init__(START, speed=0.4)
        self.largest = 0.0
        rospy.Subscriber(self.node + '/wrenches/attach_' + self.hand, WrenchStamped, self.feel)

    def feel(self, message):
        f = message.wrench.force
        self.largest = max(self.largest, (f.x ** 2 + f.y ** 2 + f.z ** 2) ** 0.5)

    def round(self):
        self.reset()
        self.at = START
        self.wait(1)
        self.move(self.hand_at())
        self.largest = 0.0
        rospy.loginfo('rescue: %s', self.attach(self.hand, 'gripper').status_message)
        self.wait(0.5)
        x, y, z = self.at
        self.move((x, y, z + LIFT))
        for x, y, z in WAY:
            self.move((x, y, z + LIFT))
        self.wait(1)
        rospy.loginfo('rescue: %s; the largest force was %.0f N',
                      self.detach(self.hand).status_message, self.largest)
        self.wait(2)


if __name__ == '__main__':
    run('rescue', Rescuer)
