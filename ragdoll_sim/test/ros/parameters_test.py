#!/usr/bin/python3
"""A wrong parameter ends the node at once, with a message that names it; settings that are given
override the scene's, and what an earlier node of the same name wrote does not."""

import re
import signal
import subprocess
import sys
import tempfile
import unittest

import dynamic_reconfigure.client
import roslib.packages
import rospy
import rostest
from client import LIMIT, wait_for
from ragdoll_msgs.msg import Model
from ragdoll_msgs.srv import LoadScene

CASES = [
    ('publish_rate', '0', ['[0.001, 1000]']),
    ('publish_rate', 'often', ['often', 'number']),
    ('publish_rate', '-60.0', ['[0.001, 1000]']),
    ('realtime_factor', '-2', ['-1', '> 0']),
    ('realtime_factor', '0', ['-1', '> 0']),
    ('start_paused', 'perhaps', ['perhaps', 'true or false']),
    ('show_limits', 'perhaps', ['perhaps', 'true or false']),
    ('show_contacts', 'perhaps', ['perhaps', 'true or false']),
    ('world_frame', '/', ['frame']),
    ('world_frame', 'a b', ['is a b;', 'without spaces']),
    ('world_frame', 'map/', ['is map/;', 'slash at its end']),
    ('world_frame', '//map', ['is //map;', 'two in a row']),
    ('world_frame', 'ragdoll/pelvis', ['is ragdoll/pelvis,', "none of the node's own"]),
    ('frame_prefix', 'a b//', ['is a b//;', 'such as robot1/', 'without spaces']),
    ('frame_prefix', 'robot1//', ['is robot1//;', 'two slashes in a row']),
    ('wrench_timeout', '0', ['(0, 60]']),
    ('coat', 'fur', ['fur', 'capsules']),
    ('max_frame_speed', '0', ['> 0']),
    ('publish_every', '-1', ['[0, 3600]']),
    ('tf_bodies', 'some', ['some', 'all, roots or none']),
    ('preset', 'quick', ['quick', 'thesis, fast, draft']),
    ('step', 'fast', ['a number', 'fast']),
    ('step', '2.0', ['is 2;', '[1e-05, 1]', '[s]']),
    ('method', '7', ['is 7;', '0 jakobsen, 1 shake, 2 rk, 3 fast']),
    ('method', 'quick', ['is quick;', '0 jakobsen, 1 shake, 2 rk, 3 fast']),
    ('method', '1.5', ['is 1.5;', '0 jakobsen, 1 shake, 2 rk, 3 fast']),
    ('integrator', 'leapfrog', ['is leapfrog;', '0 verlet, 1 euler']),
    ('numbers', 'half', ['half', 'double or float']),
    ('numbers', '2', ['text', 'is 2']),
    ('tolerance', '1e-20', ['is 1e-20', '1e-12']),
    ('gravity_z', '-200', ['[-100, 100]']),
    ('gravity_z', 'nan', ['gravity_z']),
    ('sleep', '1', ['true or false']),
    ('scene', 'nowhere', ['nowhere', 'stairs']),
    ('scene', '/nowhere/at_all.yaml', ['/nowhere/at_all.yaml']),
    ('scene', '{ragdolls: [{model: nobody}]}', ['nobody', 'human']),
    ('scene', 'package://no_such_package/x.yaml', ["no package 'no_such_package'"]),
    ('scene', 'package://no_such_package', ["no package 'no_such_package'"]),
    ('scene', 'package://ragdoll_sim', ['package://ragdoll_sim: names no file', 'PACKAGE/FILE']),
    ('scene', 'package://ragdoll_sim/', ['package://ragdoll_sim/: names no file', 'PACKAGE/FILE']),
]


PROGRAM = roslib.packages.find_node('ragdoll_sim', 'ragdoll_node')[0]


class Node:
    """A ragdoll_node in a process of its own, once it takes settings."""

    def __init__(self, test, name, **parameters):
        self.name = '/' + name
        self.log = tempfile.NamedTemporaryFile('r')
        self.process = subprocess.Popen(
            [PROGRAM, '__name:=' + name] + ['_%s:=%s' % p for p in parameters.items()],
            stdout=open(self.log.name, 'w'), stderr=subprocess.STDOUT)
        test.addCleanup(self.end, signal.SIGKILL)
        self.client = wait_for(self.settings, name)
        self.model = wait_for(lambda: rostopic_model(self.name), 'a model')
        rospy.wait_for_service(self.name + '/load_scene', LIMIT)  # offered once its settings are written

    def settings(self):
        try:
            return dynamic_reconfigure.client.Client(self.name, timeout=1)
        except rospy.ROSException:
            return None

    def now(self):
        """The settings that the node says it has."""
        return self.client.get_configuration(timeout=LIMIT)

    def says(self, **settings):
        """Waits: dynamic_reconfigure tells its own defaults first, and then the node's settings."""
        wait_for(lambda: settings.items() <= self.now().items(), settings)

    def said(self):
        with open(self.log.name) as f:
            return f.read()

    def end(self, how):
        if self.process.poll() is None:
            self.process.send_signal(how)
            self.process.wait(LIMIT)


def rostopic_model(name):
    try:
        return rospy.wait_for_message(name + '/model', Model, timeout=1)
    except rospy.ROSException:
        return None


class ParametersTest(unittest.TestCase):
    def test_a_node_that_is_started_again_knows_its_own_settings(self):
        for how in (signal.SIGINT, signal.SIGKILL):
            Node(self, 'again').end(how)
            again = Node(self, 'again')
            self.assertNotIn('unknown', again.said())
            again.end(signal.SIGINT)

    def test_settings_that_are_given_override_the_scenes(self):
        node = Node(self, 'given', scene='fall', gravity_z='-1.62', preset='draft', step='0.01',
                    damping='1', sleep='false')
        node.says(gravity_z=-1.62, preset='draft', step=0.01, damping=1.0, sleep=False, method=1)
        self.assertIn('gravity: [0, 0, -1.62]', node.model.scene_yaml)
        self.assertNotIn('unknown', node.said())
        # They go with another scene, and are there again when the node is.
        node.end(signal.SIGKILL)
        node = Node(self, 'given', scene='fall')
        node.says(gravity_z=-1.62)
        node.end(signal.SIGINT)
        self.assertEqual(rospy.get_param('/given/gravity_z'), -1.62)
        self.assertFalse(rospy.has_param('/given/sweeps'))

    def test_what_an_earlier_node_wrote_is_not_given(self):
        for how in (signal.SIGINT, signal.SIGKILL):
            node = Node(self, 'earlier', scene='fall')
            its_own = dict(step=1 / 120, gravity_z=-9.81, realtime_factor=1.0)
            node.says(**its_own)
            node.client.update_configuration(
                {'step': 0.003, 'gravity_z': -3.0, 'realtime_factor': 0.5})
            wait_for(lambda: rospy.get_param('/earlier/step') == 0.003, 'the step')
            node.end(how)
            node = Node(self, 'earlier', scene='fall')
            node.says(**its_own)
            node.end(how)

    def test_what_is_out_of_range_while_it_runs_is_refused(self):
        node = Node(self, 'ranges', scene='fall', tolerance='0.0001', threads='2')
        node.says(tolerance=0.0001, threads=2)
        before = node.now()
        for name, value in (('threads', 300), ('threads', -4), ('tolerance', -1.0),
                            ('tolerance', 5.0), ('tolerance', float('nan')), ('step', 0.0),
                            ('step', 7.0), ('method', 9), ('sweeps', 0), ('damping', -3.0),
                            ('gravity_z', 1000.0), ('gravity_x', float('inf'))):
            answer = node.client.update_configuration({name: value})
            self.assertEqual(answer[name], before[name], (name, value))
            wait_for(lambda: re.search(r'settings refused: %s: is \S+; it must be (in \[|one of )' % name,
                                       node.said()[-400:]), (name, value))
        answer = node.client.update_configuration({'tolerance': 1e-13})
        self.assertEqual(answer['tolerance'], before['tolerance'])
        wait_for(lambda: re.search(r'settings refused: tolerance: .*is 1e-13; it must be 0 \(a fixed step\), '
                                   'or at least 1e-12 m', node.said()[-400:]), 'the smallest tolerance')
        node.says(tolerance=0.0001, threads=2, gravity_z=before['gravity_z'])

    def test_what_is_set_beside_a_preset_goes_on_top_of_it(self):
        node = Node(self, 'beside', scene='fall')
        node.says(preset='balanced', step=1 / 120)
        kept = dict(node.client.update_configuration({'preset': 'draft', 'step': 0.005, 'damping': 0.3}))
        self.assertEqual((kept['preset'], kept['step'], kept['damping']), ('draft', 0.005, 0.3))
        node.client.update_configuration({'preset': 'balanced'})
        node.says(preset='balanced', step=1 / 120, damping=0.0)
        again = node.client.update_configuration(  # as dynparam load
            {name: value for name, value in kept.items() if name != 'groups'})
        self.assertEqual((again['preset'], again['step'], again['damping']), ('draft', 0.005, 0.3))

    def test_what_a_user_sets_while_it_runs_stays(self):
        node = Node(self, 'stays', scene='fall', damping='1', step='0.004')
        node.says(step=0.004, damping=1.0)  # no default: the node has written its settings
        rospy.set_param('/stays/gravity_z', -3.0)
        rospy.set_param('/stays/damping', 2.0)
        node.end(signal.SIGINT)
        self.assertEqual(rospy.get_param('/stays/gravity_z'), -3.0)
        self.assertEqual(rospy.get_param('/stays/damping'), 2.0)
        self.assertFalse(rospy.has_param('/stays/sweeps'))  # what the node wrote is gone
        Node(self, 'stays', scene='fall').says(gravity_z=-3.0, damping=2.0)

    def test_methods_by_name(self):
        node = Node(self, 'named', scene='fall', method='jakobsen', integrator='euler')
        node.says(method=0, integrator=1)
        self.assertIn('method: jakobsen', node.model.scene_yaml)
        node.end(signal.SIGINT)
        self.assertEqual(rospy.get_param('/named/method'), 'jakobsen')

    def test_the_log_says_what_overrides_the_scene(self):
        node = Node(self, 'overrides', scene='fall', gravity_z='-1.62', method='shake', coat='sticks',
                    realtime_factor='2')
        node.end(signal.SIGINT)  # then all of its log is written
        self.assertRegex(node.said(), "parameters override the scene's: "
                         r"method shake, gravity_z -1\.62, coat sticks\W*0?m?\n")
        node = Node(self, 'plain', scene='fall', realtime_factor='2', coat='')
        node.end(signal.SIGINT)
        self.assertIn("scene 'fall'", node.said())
        self.assertNotIn('override', node.said())

    def test_a_wrong_parameter_is_named(self):
        for i, (name, value, words) in enumerate(CASES):
            run = subprocess.run(
                [PROGRAM, '__name:=wrong_%d' % i, '_%s:=%s' % (name, value)], timeout=LIMIT,
                stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
            self.assertEqual(run.returncode, 1, run.stdout)
            for word in ['/wrong_%d/%s' % (i, name)] + words:
                self.assertIn(word, run.stdout)


    def test_a_scene_with_the_world_frame_among_its_own_is_refused(self):
        node = Node(self, 'rooted', scene='fall', world_frame='anna/lab')
        load = rospy.ServiceProxy(node.name + '/load_scene', LoadScene)
        named = node.model.scene_yaml.replace('name: ragdoll', 'name: anna')
        sensed = named + 'sensors: [{name: lab, type: imu, segment: torso}]\n'
        self.assertTrue(load(yaml=named).success)
        answer = load(yaml=sensed)
        self.assertFalse(answer.success)
        self.assertEqual(answer.status_message, '~world_frame: is anna/lab, a frame of this scene\'s; '
                         "it must be none of the node's own")
        node.end(signal.SIGINT)


if __name__ == '__main__':
    rospy.init_node('parameters_test')
    rostest.rosrun('ragdoll_sim', 'parameters', ParametersTest, sys.argv)
