#!/usr/bin/python3
"""~markers are light: rigid parts are told once, TF moves them, and nothing is lost to who reads slowly."""

import os
import signal
import subprocess
import sys
import unittest

import rospy
import rostest
from client import LIMIT, PROGRAM, Inbox, start_node, wait_for
from ragdoll_msgs.msg import State
from raw import Subscriber
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import Marker, MarkerArray
from xmlrpc.client import ServerProxy

MOST = 20e3  # [bytes/s] of one body in the default coat, after the first second


class Shown:
    """What a viewer shows of the markers that have arrived."""

    def __init__(self):
        self.markers = {}  # (ns, id) -> marker, when it came [s of the simulation]

    def take(self, message, now):
        for m in message.markers:
            if m.action == Marker.DELETEALL:
                self.markers.clear()
            elif m.action == Marker.DELETE:
                self.markers.pop((m.ns, m.id), None)
            else:
                self.markers[(m.ns, m.id)] = (m, now)

    def visible(self, ns, now):
        return [m for (n, _), (m, at) in self.markers.items()
                if n == ns and (m.lifetime.to_sec() == 0 or now < at + m.lifetime.to_sec())]


def cross(a, b):
    return (a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0])


def moved(p, transform):
    q, t = transform.rotation, transform.translation
    v = (q.x, q.y, q.z)
    twice = [2 * c for c in cross(v, p)]
    turned = [a + q.w * b + c for a, b, c in zip(p, twice, cross(v, twice))]
    return (turned[0] + t.x, turned[1] + t.y, turned[2] + t.z)


class LightTest(unittest.TestCase):
    def world_points(self, marker, frames):
        """Of a marker, by the poses that TF has last told."""
        points = [(p.x, p.y, p.z) for p in marker.points]
        frame = marker.header.frame_id
        while frame != 'world':
            frame, t = frames[frame]
            points = [moved(p, t) for p in points]
        return points

    def test_one_body_is_below_the_budget(self):
        client = start_node(self, 'budget')
        sizes = []

        def add(message):
            sizes.append((client.states.all()[-1].time, len(message._buff)))
        rospy.Subscriber('/budget/markers', rospy.AnyMsg, add, queue_size=None)
        client.load(path='stairs')
        wait_for(lambda: sizes and sizes[-1][0] > 6, 'six seconds')
        begin = sizes[0][0] if sizes[0][0] < 1 else 0
        told = sum(size for time, size in sizes if begin + 1 < time <= begin + 6) / 5
        print('one body: %.1f kB/s of markers' % (told / 1e3))
        self.assertLess(told, MOST)
        self.assertGreater(told, 0)

    def test_tf_moves_the_rigid_parts_to_where_the_coat_is(self):
        """One node moves them by TF, one without frames draws the same coat in the world frame."""
        pictures = {}
        for name, bodies in (('locked', 'all'), ('streamed', 'none')):
            client = start_node(self, name, scene='fall', start_paused='true', tf_bodies=bodies)
            markers = Inbox('/' + name + '/markers', MarkerArray)
            tf = Inbox('/tf', TFMessage)
            client.restart()
            shown = Shown()
            new = markers.reader()

            def coat():
                for message in new():
                    shown.take(message, 0)
                return [m for (ns, _), (m, _) in shown.markers.items() if ns == 'coat']
            wait_for(coat, 'the coat')

            def picture():
                frames = {t.child_frame_id: (t.header.frame_id, t.transform)
                          for m in tf.all() for t in m.transforms}
                return [p for m in coat() for p in self.world_points(m, frames)]
            looks = []  # at what has arrived since the last one: ((markers, frames), picture)

            def stands():
                """The same twice, and no longer the start, which may still be on its way."""
                counts = len(markers.all()), len(tf.all())
                told = counts if bodies == 'all' else counts[:1]
                if not looks or all(now > last + 2 for now, last in zip(told, looks[-1][0])):
                    looks.append((counts, picture()))
                return len(looks) > 2 and looks[0][1] != looks[-1][1] == looks[-2][1]
            wait_for(lambda: bodies == 'none' or tf.all(), 'frames')
            stands()
            client.step(70)  # told before it moved, or anew
            wait_for(stands, 'a picture that stands')
            pictures[name] = looks[-1][1]
            locked = [m for m in coat() if m.frame_locked]
            self.assertEqual(bool(locked), bodies == 'all')
            for m in locked:
                self.assertTrue(m.header.stamp.is_zero())
                self.assertEqual(m.lifetime.to_sec(), 0)
                self.assertTrue(m.header.frame_id.startswith('ragdoll/'), m.header.frame_id)
        a, b = (sorted(pictures[name]) for name in ('locked', 'streamed'))
        self.assertEqual(len(a), len(b))
        self.assertGreater(len(a), 1000)
        for axis in range(3):
            for x, y in zip(*(sorted(p[axis] for p in points) for points in (a, b))):
                self.assertAlmostEqual(x, y, 3)

    def test_nothing_stays_when_the_node_ends(self):
        node = subprocess.Popen([PROGRAM, '__name:=ending', '_scene:=fall'])
        self.addCleanup(lambda: node.poll() is None and node.kill())
        markers = Inbox('/ending/markers', MarkerArray)
        markers.first(lambda a: any(m.ns == 'coat' for m in a.markers), 'the body')
        seen = len(markers.all())
        node.send_signal(signal.SIGINT)
        self.assertEqual(node.wait(LIMIT), 0)
        wait_for(lambda: any(m.action == Marker.DELETEALL for a in markers.all()[seen:]
                             for m in a.markers), 'the end of all markers')

    def test_bones_that_stretch_are_told_anew(self):
        client = start_node(self, 'stretching', scene='fall', preset='thesis', sweeps=1)
        markers = Inbox('/stretching/markers', MarkerArray)
        client.restart()
        client.call_pause(False)
        markers.first(lambda a: any(m.ns == 'coat' and m.action == Marker.ADD and
                                    m.header.frame_id == 'world' for m in a.markers),
                      'a coat in the world frame')

    def test_a_new_listener_to_states_may_be_an_rviz_that_was_reset(self):
        client = start_node(self, 'forgotten', scene='fall', start_paused='true')
        markers = Inbox('/forgotten/markers', MarkerArray)

        def told(new):
            return {m.ns for a in new() for m in a.markers} >= {'obstacles', 'coat'}
        wait_for(lambda new=markers.reader(): told(new), 'all')
        client.restart()
        new = markers.reader()
        new()
        uri = ServerProxy(os.environ['ROS_MASTER_URI']).lookupNode('/test', '/forgotten')[2]
        reader = Subscriber(uri, '/forgotten/state', State)
        wait_for(lambda: told(new), 'all again')
        reader.close()

    def test_who_reads_slowly_keeps_floor_and_body(self):
        client = start_node(self, 'slow', scene='fall')
        uri = ServerProxy(os.environ['ROS_MASTER_URI']).lookupNode('/test', '/slow')[2]
        reader = Subscriber(uri, '/slow/markers', MarkerArray)
        shown = Shown()

        def now():
            return client.states.all()[-1].time
        for _ in range(8):
            shown.take(reader.next(), now())
            at = now()
            wait_for(lambda: now() > at + 0.8, 'some time')
            if ('obstacles', 0) in shown.markers:
                self.assertTrue(shown.visible('obstacles', now()))
                self.assertTrue(shown.visible('coat', now()))
        self.assertIn(('obstacles', 0), shown.markers)
        reader.close()


if __name__ == '__main__':
    rospy.init_node('light_test')
    rostest.rosrun('ragdoll_sim', 'light', LightTest, sys.argv)
