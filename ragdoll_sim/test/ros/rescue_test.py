#!/usr/bin/python3
"""rescue.launch: the gripper drags the body by its hand over the floor and up the ramp, and feels it."""

import os
import sys
import unittest

import roslaunch.config
import roslaunch.xmlloader
import roslib.packages
import rospy
import rostest
from client import Client, Inbox, wait_for
from geometry_msgs.msg import WrenchStamped
from visualization_msgs.msg import Marker, MarkerArray


class RescueTest(unittest.TestCase):
    def test_the_body_is_dragged_up_the_ramp(self):
        client = Client()
        force = Inbox('/ragdoll/wrenches/attach_right_hand', WrenchStamped)

        def middle(axis):
            points = client.states.all()[-1].ragdolls[0].positions
            return sum(getattr(p, axis) for p in points) / len(points)
        dragged = force.first(lambda m: m.wrench.force.x < -30, 'a force against the way')
        self.assertEqual(dragged.header.frame_id, 'gripper')
        picture = Inbox('/rescue/gripper', MarkerArray)
        seen, told = force.reader(), set()

        def is_drawn():
            """The arrow ends at the gripper and is a force that it has felt, 2 mm/N."""
            told.update((m.wrench.force.x, m.wrench.force.y, m.wrench.force.z) for m in seen())
            arrows = [m for p in picture.all()[-5:] for m in p.markers if m.type == Marker.ARROW]
            for arrow in arrows:
                self.assertEqual(arrow.header.frame_id, 'gripper')
                tail, tip = arrow.points
                self.assertEqual((tip.x, tip.y, tip.z), (0, 0, 0))
            return any(max(abs(500 * p + f) for p, f in zip(
                (m.points[0].x, m.points[0].y, m.points[0].z), one)) < 1e-6
                for m in arrows for one in told)
        wait_for(is_drawn, 'an arrow of the force')
        wait_for(lambda: middle('x') > 2, 'a body on its way')
        wait_for(lambda: middle('z') > 0.35, 'a body on the ramp')

    def plots(self, *arguments):
        """What rescue.launch has rqt_plot plot."""
        path = os.path.join(roslib.packages.get_pkg_dir('ragdoll'), 'launch', 'rescue.launch')
        config = roslaunch.config.ROSLaunchConfig()
        roslaunch.xmlloader.XmlLoader().load(path, config, argv=list(arguments), verbose=False)
        return [field for node in config.nodes if node.type == 'rqt_plot' for field in node.args.split()]

    def test_the_force_is_plotted(self):
        topic = '/ragdoll/wrenches/attach_right_hand'
        self.assertEqual(self.plots(), [])
        self.assertEqual(self.plots('plot:=true'), [topic + '/wrench/force/' + axis for axis in 'xyz'])
        Inbox(topic, WrenchStamped).first(lambda m: m.wrench.force.x != 0, 'the force that is plotted')


if __name__ == '__main__':
    rospy.init_node('rescue_demo_test')
    rostest.rosrun('ragdoll_sim', 'rescue_demo', RescueTest, sys.argv)
