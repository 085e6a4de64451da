#!/usr/bin/python3
"""docs/ros_api.md describes the running node: nothing undocumented, nothing that is not there."""

import re
import subprocess
import sys
import unittest

import dynamic_reconfigure.client
import rosgraph
import roslib.packages
import rospy
import rosservice
import rostest
from client import LIMIT, Client, wait_for
from page import NODE, column, of_node, table
from ragdoll_msgs.msg import Model

CLOCK = '/clock'  # there only with ~publish_clock or /use_sim_time: clock_test.py


class ApiTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.client = Client(NODE)  # the node is there
        cls.master = rosgraph.Master('/api_test')
        wait_for(lambda: rosservice.get_service_list(NODE) and
                 NODE + '/set_parameters' in rosservice.get_service_list(NODE), 'all services')

    def test_topics(self):
        types = dict(self.master.getTopicTypes())
        for heading, topics in zip(('Published topics', 'Subscribed topics'), of_node(NODE)):
            told = column(heading)
            # Those of a scene's own obstacles have a table of their own.
            of_scene = {topic for topic in topics if topic.startswith(NODE + '/wrenches/')}
            if heading == 'Published topics':
                self.assertEqual(of_scene, {NODE + '/wrenches/plane_0'})
                self.assertIn(NODE + '/wrenches/<name>', column('Wrenches'))
            topics = topics - of_scene
            self.assertEqual(set(told) - {CLOCK}, topics - {CLOCK}, heading)
            for topic in topics:
                # A topic that only this node listens to has no type until someone publishes it.
                self.assertIn(types.get(topic, '*'), (told[topic], '*'), topic)

    def test_services(self):
        told = column('Services')
        self.assertEqual(set(told), set(rosservice.get_service_list(NODE)))
        for service, kind in told.items():
            self.assertEqual(rosservice.get_service_type(service), kind, service)

    def test_parameters_of_the_start(self):
        """The node itself lists what it knows when it meets one that it does not."""
        program = roslib.packages.find_node('ragdoll_sim', 'ragdoll_node')[0]
        node = subprocess.Popen([program, '__name:=other', '_nonsense:=1'], stdout=subprocess.PIPE,
                                stderr=subprocess.STDOUT, universal_newlines=True)
        self.addCleanup(node.stdout.close)
        self.addCleanup(node.wait)
        self.addCleanup(node.kill)
        known = ''
        for line in node.stdout:
            match = re.search(r'/other/nonsense; there are ([a-z_, ]*)', line)
            if match:
                known = match.group(1)
                break
        told = {name[len(NODE) + 1:] for name in column('Parameters read at the start')}
        self.assertEqual(set(known.split(', ')), told)

    def test_types_and_defaults_of_the_start(self):
        """The node tells both when it meets a value that has no type of its parameters'."""
        program = roslib.packages.find_node('ragdoll_sim', 'ragdoll_node')[0]
        defaults = column('Parameters read at the start', 2)
        for name, kind in column('Parameters read at the start').items():
            key = name[len(NODE) + 1:]
            rospy.set_param('/wrong_%s/%s' % (key, key), [1, 2])
            run = subprocess.run([program, '__name:=wrong_' + key], timeout=LIMIT,
                                 stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                 universal_newlines=True)
            self.assertEqual(run.returncode, 1, run.stdout)
            self.assertIn('must be %s, by default %s, is' % (
                {'number': 'a number'}.get(kind, kind), defaults[name].split(':')[0]), run.stdout)

    def test_settings(self):
        settings = dynamic_reconfigure.client.Client(NODE, timeout=LIMIT)
        there = {NODE + '/' + p['name']: p
                 for p in settings.get_parameter_descriptions(timeout=LIMIT)}
        told = column('Settings that change while it runs')
        self.assertEqual(set(there), set(told))
        ranges = column('Settings that change while it runs', 2)
        for name, p in there.items():
            self.assertEqual(p['type'], told[name], name)
            limits = ranges[name].split(' ... ')
            if len(limits) == 2:
                self.assertEqual([float(x) for x in limits], [p['min'], p['max']], name)
            for number, label in re.findall(r'(\d) (\w+)', ranges[name]):
                self.assertIn("'name': '%s_%s'" % (name.rsplit('/')[-1], label), p['edit_method'])
                self.assertIn("'value': %s" % number, p['edit_method'])

    def test_no_parameter_on_the_server_is_undocumented(self):
        told = set(column('Parameters read at the start')) | set(
            column('Settings that change while it runs'))
        there = {p for p in self.master.getParamNames() if p.startswith(NODE + '/')}
        self.assertLessEqual(there, told)

    def test_the_relay(self):
        relay = '/relay'
        model = rospy.Publisher(relay + '/model', Model, latch=True, queue_size=1)
        model.publish(self.client.model)
        told = table('The relay state_to_markers', relay)
        wait_for(lambda: of_node(relay)[0] >= told['publishes'] and
                 of_node(relay)[1] >= told['subscribes'], 'all topics of the relay')
        published, subscribed = of_node(relay)
        self.assertEqual(told['publishes'], published - {'/rosout'})
        self.assertEqual(told['subscribes'], subscribed)
        self.assertEqual(told['parameter'], {relay + '/coat', relay + '/frame_prefix'})
        program = roslib.packages.find_node('ragdoll_sim', 'state_to_markers')[0]
        run = subprocess.run([program, '__name:=wrong_relay', '_coat:=nonsense'], timeout=LIMIT,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, universal_newlines=True)
        self.assertEqual(run.returncode, 1, run.stdout)
        self.assertIn('/wrong_relay/coat', run.stdout)

    def test_what_is_refused_is_answered(self):
        """Every service that the page says refuses something does so with a message."""
        bad = {'poke': {'body_name': 'paw'}, 'load_scene': {}, 'step': {'steps': 1},
               'set_state': {'snapshot': b'no'}, 'attach': {'body_name': 'torso', 'frame': 'world'},
               'detach': {'body_name': 'head'}}
        refusing = {name.rsplit('/', 1)[-1] for name, text in column('Services', 3).items() if text}
        self.assertEqual(refusing - {'set_parameters'}, set(bad))
        self.client.call_pause(False)
        for name, fields in bad.items():
            proxy = rospy.ServiceProxy(NODE + '/' + name,
                                       rosservice.get_service_class_by_name(NODE + '/' + name))
            answer = proxy(**fields)
            self.assertFalse(answer.success, name)
            self.assertGreater(len(answer.status_message), 10, name)


if __name__ == '__main__':
    rospy.init_node('api_test')
    rostest.rosrun('ragdoll_sim', 'api', ApiTest, sys.argv)
