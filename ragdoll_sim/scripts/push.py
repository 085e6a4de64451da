#!/usr/bin/python3
"""A gripper that pushes the ragdoll along the floor and drags it back by its hand, again and again.

Broadcasts the TF frames `gripper` (the scene's paddle follows it) and `gripper/fingers`, which hang
under it. Stands for a robot: to the ragdoll it makes no difference who publishes the frames.
Parameters: ~node (ragdoll), ~hand (right_hand, or ben/right_hand of one of several ragdolls),
~speed (0.5 m/s), ~rounds (0: without end).
"""

import os
import sys

import rospy

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))  # run by catkin's relay, too
from gripper import Gripper, run  # noqa: E402

FINGERS = 0.25        # [m] below the gripper
AT_REST = (-1.0, 0.0, 0.2)
PUSH_TO = (0.6, 0.0, 0.2)
ABOVE = 1.3           # [m] height to travel at
DRAG_TO = (-1.0, 0.5, 1.1)


class Pusher(Gripper):
    def __init__(self):
        super().__init__(AT_REST, speed=0.5, under=[('gripper/fingers', FINGERS)])

    def grasp(self):
        """Brings the fingers to the hand and holds it."""
        self.move((self.at[0], self.at[1], ABOVE))
        x, y, z = self.hand_at()
        self.move((x, y, ABOVE))
        x, y, z = self.hand_at()
        self.move((x, y, z + FINGERS))
        answer = self.attach(self.hand, 'gripper/fingers')
        rospy.loginfo('push: %s', answer.status_message)

    def round(self):
        self.reset()
        self.move(AT_REST)
        self.wait(0.5)
        self.move(PUSH_TO)
        self.wait(0.5)
        self.grasp()
        self.move((self.at[0], self.at[1], ABOVE))
        self.move(DRAG_TO)
        self.wait(1)
        rospy.loginfo('push: %s', self.detach(self.hand).status_message)
        self.wait(2)
        self.move((self.at[0], self.at[1], ABOVE))
        self.move((AT_REST[0], AT_REST[1], ABOVE))


if __name__ == '__main__':
    run('push', Pusher)
