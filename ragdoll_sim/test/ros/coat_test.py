#!/usr/bin/python3
"""A scene's coat: and the parameter ~coat: what the markers of each kind are."""

import sys
import unittest

import rospy
import rostest
from client import Client, Inbox
from ragdoll_msgs.srv import LoadScene
from visualization_msgs.msg import Marker, MarkerArray

# Types of the markers and how many points they have, docs/body.md: a body has 24 sticks and 16
# particles. What is rigid comes in pieces.
COATS = {
    'none': [],
    'sticks': [(Marker.LINE_LIST, 48), (Marker.SPHERE_LIST, 16)],
    'boxes': [(Marker.TRIANGLE_LIST, 3 * 192)],
    'capsules': [(Marker.TRIANGLE_LIST, 3 * 2856)],
    'skin': [(Marker.TRIANGLE_LIST, 3 * 3020)],
}


def coat_of(message):
    return [m for m in message.markers if m.ns == 'coat']


def looks(message):
    points = {}
    for m in coat_of(message):
        points[m.type] = points.get(m.type, 0) + len(m.points)
    return sorted(points.items(), key=lambda item: item[0] != Marker.LINE_LIST)


class CoatTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.clients = {node: Client(node) for node in ('/ragdoll', '/dressed')}
        cls.height = 10  # [m] each scene's body is at another, which tells whose markers they are

    def worn(self, node, coat):
        """Markers of a paused scene that says `coat`, and where its particles are."""
        client = self.clients[node]
        CoatTest.height += 10
        reply = client.service('load_scene', LoadScene)(
            yaml='ragdolls: [{model: human, position: [1, 2, %d]}]\ncoat: %s\n' % (
                self.height, coat))
        self.assertTrue(reply.success, reply.status_message)

        def is_there(z):
            return abs(z - self.height) < 2
        body = client.states.first(lambda m: is_there(m.ragdolls[0].positions[0].z), 'the body')
        markers = Inbox(node + '/markers', MarkerArray)
        try:
            shown = markers.first(
                lambda m: any(k.ns == 'sticks' and is_there(k.points[0].z) for k in m.markers),
                'its markers')
        finally:
            markers.subscriber.unregister()
        return shown, body.ragdolls[0].positions

    def test_of_the_scene(self):
        for coat, expected in COATS.items():
            shown = self.worn('/ragdoll', coat)[0]
            self.assertEqual(looks(shown), expected, coat)

    def test_of_the_parameter_goes_before_the_scenes(self):
        for coat in COATS:
            self.assertEqual(looks(self.worn('/dressed', coat)[0]), COATS['skin'], coat)

    def test_is_around_the_body(self):
        """What is rigid: around the origin of the frame that moves it (light_test.py has more)."""
        for coat in ('boxes', 'capsules', 'skin'):
            shown, particles = self.worn('/ragdoll', coat)
            for mesh in coat_of(shown):
                self.assertEqual(len(mesh.colors), len(mesh.points), coat)
                for axis in 'xyz':
                    points = [getattr(p, axis) + getattr(mesh.pose.position, axis)
                              for p in mesh.points]
                    inside = [getattr(p, axis) for p in particles]
                    if mesh.frame_locked:
                        self.assertLess(max(abs(p) for p in points), 0.8, coat)
                        continue
                    self.assertLess(min(points), min(inside), coat)
                    self.assertGreater(max(points), max(inside), coat)
                    self.assertLess(max(points) - min(points), max(inside) - min(inside) + 0.4, coat)


if __name__ == '__main__':
    rospy.init_node('coat_test')
    rostest.rosrun('ragdoll_sim', 'coat', CoatTest, sys.argv)
