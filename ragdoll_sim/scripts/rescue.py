#!/usr/bin/python3
"""A gripper that takes the limp body's hand, drags the body over the floor and up a ramp, and lets go.

Broadcasts the TF frame `gripper`, and draws it on ~gripper for rviz, with an arrow that ends at it: the
force on it, 2 mm/N. The force itself is on ~wrenches/attach_<hand> of the node;
plot:=true of rescue.launch plots it.
Parameters: ~node (ragdoll), ~hand (right_hand, or ben/right_hand of one of several ragdolls),
~speed (0.4 m/s), ~rounds (0: without end).
"""

import os
import sys

import rospy
from geometry_msgs.msg import Point, Vector3, WrenchStamped
from std_msgs.msg import ColorRGBA
from visualization_msgs.msg import Marker, MarkerArray

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))  # run by catkin's relay, too
from gripper import Gripper, run  # noqa: E402

START = (0.0, 0.0, 1.5)         # [m]
LIFT = 0.5                      # [m] that the hand is held up while it is dragged
FINGER, PALM, WRIST = (0.05, 0.02, 0.12), (0.07, 0.16, 0.04), (0.07, 0.07, 0.22)  # [m] boxes
METAL, RED = ColorRGBA(0.32, 0.34, 0.38, 1), ColorRGBA(0.92, 0.26, 0.21, 1)
ARROW = 0.002                   # [m/N]
TELLS = 3                       # of the frame, until the next picture
WAY = ((2.0, 0.0, 0.0), (5.4, 0.0, 0.65))   # [m] foot of the ramp, and up on it


class Rescuer(Gripper):
    def __init__(self):
        super().__init__(START, speed=0.4)
        self.largest, self.force, self.told = 0.0, (0.0, 0.0, 0.0), 0
        self.pictures = rospy.Publisher('~gripper', MarkerArray, queue_size=1)
        rospy.Subscriber(self.node + '/wrenches/' + self.holder, WrenchStamped, self.feel)

    def feel(self, message):
        f = message.wrench.force
        self.force = (f.x, f.y, f.z)
        self.largest = max(self.largest, sum(c * c for c in self.force) ** 0.5)

    def tell(self):
        super().tell()
        self.told += 1
        if self.told % TELLS == 0:
            self.pictures.publish(self.picture())

    def picture(self):
        """A gripper that points down, and the force on it."""
        shapes = [((0, -0.06, 0.01), FINGER), ((0, 0.06, 0.01), FINGER), ((0, 0, 0.09), PALM),
                  ((0, 0, 0.2), WRIST)]
        markers = []
        for at, size in shapes:
            marker = self.marker(Marker.CUBE, len(markers), size, METAL)
            marker.pose.position = Point(*at)
            markers.append(marker)
        arrow = self.marker(Marker.ARROW, len(markers), (0.04, 0.09, 0.12), RED)
        arrow.points = [Point(*(-ARROW * c for c in self.force)), Point()]
        if self.force == (0.0, 0.0, 0.0):
            arrow.action = Marker.DELETE
        return MarkerArray(markers + [arrow])

    @staticmethod
    def marker(kind, number, size, color):
        marker = Marker(type=kind, id=number, ns='gripper', scale=Vector3(*size), color=color)
        marker.header.frame_id = 'gripper'  # stamp 0: wherever it is
        marker.pose.orientation.w = 1
        return marker

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
        self.force = (0.0, 0.0, 0.0)
        self.wait(2)


if __name__ == '__main__':
    run('rescue', Rescuer)
