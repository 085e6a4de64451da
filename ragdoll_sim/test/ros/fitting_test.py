#!/usr/bin/python3
"""How a node fits in among others: prefixes of frames, messages by simulated time, few frames of many
bodies, velocities of joints, the coat while it runs, and the arguments of the launch file."""

import subprocess
import sys
import unittest

import rospy
import rostest
import yaml
from client import LIMIT, Inbox, start_node, wait_for
from diagnostic_msgs.msg import DiagnosticArray
from dynamic_reconfigure.client import Client as Settings
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import JointState
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import MarkerArray


def crowd(count):
    return 'ragdolls:\n' + ''.join(
        '  - {name: r%d, model: {sticks: [[p, q]], particles: {p: {position: [0, 0, 0], mass: 1}, '
        'q: {position: [0, 0, 1], mass: 1}}}, position: [%d, 0, 0]}\n' % (i, i)
        for i in range(count))


class FittingTest(unittest.TestCase):
    def frames(self, inbox, node):
        """All that this node has published."""
        return {t.child_frame_id for m in inbox.all() if m._connection_header['callerid'] == node
                for t in m.transforms}

    def test_a_prefix_is_of_all_frames(self):
        tf = Inbox('/tf', TFMessage) if start_node(self, 'first', scene='fall') else None
        second = start_node(self, 'second', scene='fall', frame_prefix='robot1/')
        wait_for(lambda: self.frames(tf, '/second') and self.frames(tf, '/first'), 'frames')
        self.assertEqual(self.frames(tf, '/second'),
                         {'robot1/' + f for f in self.frames(tf, '/first')})
        answer = second.poke('head', (1, 0, 0), frame='robot1/ragdoll/head')
        self.assertTrue(answer.success, answer.status_message)
        answer = second.poke('head', (1, 0, 0), frame='robot1/ragdoll/tail')
        self.assertFalse(answer.success)
        self.assertIn('robot1/ragdoll/head', answer.status_message)
        second.load(path='two')
        wait_for(lambda: 'robot1/anna/head' in self.frames(tf, '/second'), 'the prefix in a scene')
        reports = Inbox('/diagnostics', DiagnosticArray)
        seen = {}
        wait_for(lambda: [seen.update({s.name: s.message}) for m in reports.all()
                          for s in m.status] and len(seen) > 1, 'reports of both')
        self.assertFalse([m for m in seen.values() if 'publishes' in m])

    def test_every_sixtieth_of_a_simulated_second_is_published(self):
        for factor in ('-1', '4', '0.5'):
            name = 'sampled_' + factor.replace('-', 'm').replace('.', '_')
            client = start_node(self, name, scene='weightless', realtime_factor=factor,
                                publish_every='0.016666666666666666', start_paused='true')
            client.restart()
            client.call_pause(False)
            wait_for(lambda: client.states.all()[-1].time > 2, 'two seconds')
            client.call_pause(True)
            times = [m.time for m in client.states.all()]
            times = times[len(times) - times[::-1].index(0.0) - 1:]  # from the restart on
            told = [t for t in times if t <= 2]
            self.assertEqual([round(60 * t) for t in told], list(range(len(told))), factor)
            self.assertTrue(all(abs(60 * t - round(60 * t)) < 1e-6 for t in told))

    def test_few_frames_of_many_bodies(self):
        log = Inbox('/rosout', Log)
        for name, parameters, count, expected in (
                ('every', {'tf_bodies': 'all'}, 60, 120), ('fifty', {}, 50, 100),
                ('few', {}, 51, 51), ('nothing', {'tf_bodies': 'none'}, 3, 0)):
            client = start_node(self, name, **parameters)
            client.load(yaml=crowd(count))
            tf = Inbox('/tf', TFMessage)
            seen = len(client.states.all())
            wait_for(lambda: len(client.states.all()) > seen + 20, 'states')
            wait_for(lambda: not expected or any(
                len(m.transforms) == expected for m in tf.all()
                if m._connection_header['callerid'] == '/' + name), 'the frames')
            if not expected:
                self.assertFalse([f for f in self.frames(tf, '/' + name) if f.startswith('r')])
            tf.subscriber.unregister()
        chosen = [m for m in log.all() if '/tf has one frame of each' in m.msg]
        self.assertEqual([(m.name, m.level) for m in chosen], [('/few', Log.INFO)])
        self.assertIn('51 bodies', chosen[0].msg)
        # Roots of bodies with more frames than that.
        client = start_node(self, 'roots', scene='two', tf_bodies='roots')
        tf = Inbox('/tf', TFMessage)
        wait_for(lambda: self.frames(tf, '/roots'), 'frames')
        self.assertEqual(self.frames(tf, '/roots'), {'anna/pelvis', 'ben/pelvis'})

    def test_joints_have_velocities(self):
        client = start_node(self, 'moving', scene='fall', start_paused='true')
        joints = Inbox('/moving/joint_states', JointState)
        client.restart()
        client.step(80)
        h = 1.0 / 120

        def after_a_step():
            seen = len(joints.all())
            client.step(1)
            return wait_for(lambda: joints.all()[seen:], 'joints')[-1]
        one, two = after_a_step(), after_a_step()
        self.assertEqual(len(two.velocity), len(two.name))
        self.assertGreater(max(abs(v) for v in two.velocity), 0.1)
        for name, a, b, v in zip(two.name, one.position, two.position, two.velocity):
            self.assertAlmostEqual((b - a) / h, v, 6, name)

    def test_another_coat_while_it_runs(self):
        client = start_node(self, 'dressed', scene='fall', start_paused='true')
        settings = Settings('/dressed', timeout=LIMIT)
        markers = Inbox('/dressed/markers', MarkerArray)

        def coats():
            found = {}
            for message in markers.all():
                for m in message.markers:
                    if m.action == 3:
                        found.clear()
                    if m.ns == 'coat':
                        found[m.id] = len(m.points)
            return sum(found.values())
        wait_for(coats, 'a coat')
        before = coats()
        self.assertEqual(settings.update_configuration({'coat': 'fur'})['coat'], '')
        settings.update_configuration({'coat': 'boxes'})
        wait_for(lambda: 0 < coats() != before, 'boxes')
        client.load(path='stairs')
        self.assertEqual(settings.get_configuration(timeout=LIMIT)['coat'], 'boxes')

    def test_arguments_of_the_launch_file(self):
        def parameters(*arguments):
            told = subprocess.run(['roslaunch', '--dump-params', 'ragdoll', 'ragdoll.launch',
                                   'rviz:=false'] + list(arguments), stdout=subprocess.PIPE)
            return yaml.safe_load(told.stdout)
        plain = parameters()
        self.assertNotIn('/ragdoll/preset', plain)
        given = parameters('coat:=boxes', 'world_frame:=map', 'publish_clock:=true', 'preset:=draft',
                           'frame_prefix:=robot1/')
        for name, value in (('coat', 'boxes'), ('world_frame', 'map'), ('publish_clock', True),
                            ('preset', 'draft'), ('frame_prefix', 'robot1/')):
            self.assertEqual(given['/ragdoll/' + name], value)


if __name__ == '__main__':
    rospy.init_node('fitting_test')
    rostest.rosrun('ragdoll_sim', 'fitting', FittingTest, sys.argv)
