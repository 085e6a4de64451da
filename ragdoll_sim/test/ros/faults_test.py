#!/usr/bin/python3
"""What goes wrong around a running node: the master dies, a listener does not read, someone
interrupts, a file is gone, the clock does not tick. Each test starts nodes of its own."""

import os
import re
import shutil
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest
from xmlrpc.client import ServerProxy
from xmlrpc.server import SimpleXMLRPCServer

import roslib.packages
import rosbag
import rospy
import rostest
from bags import Recorder
from client import LIMIT, Client, Inbox, bits, wait_for
from diagnostic_msgs.msg import DiagnosticArray, DiagnosticStatus
from ragdoll_msgs.msg import State
from ragdoll_msgs.srv import GetState, LoadScene, Step
from raw import Service, Subscriber
from rosgraph_msgs.msg import Log
from sensor_msgs.msg import JointState
from std_srvs.srv import SetBool, Trigger
from visualization_msgs.msg import MarkerArray

PROGRAM = roslib.packages.find_node('ragdoll_sim', 'ragdoll_node')[0]
SCENES = os.path.join(roslib.packages.get_pkg_dir('ragdoll_sim'), 'scenes')


class Node:
    """A ragdoll_node in a process of its own."""

    def __init__(self, name, master=None, **parameters):
        self.name = '/' + name
        self.environment = dict(os.environ)
        if master:
            self.environment['ROS_MASTER_URI'] = master
        self.master = ServerProxy(self.environment['ROS_MASTER_URI'])
        arguments = ['_%s:=%s' % item for item in parameters.items()]
        self.process = subprocess.Popen([PROGRAM, '__name:=' + name] + arguments,
                                        env=self.environment)

    def uri(self):
        return wait_for(lambda: self.master.lookupNode('/test', self.name)[2], self.name)

    def service(self, name, kind):
        name = self.name + '/' + name
        uri = wait_for(lambda: self.master.lookupService('/test', name)[2], name)
        return Service(uri, name, kind)

    def subscriber(self, topic, kind, **options):
        """Once the topic is advertised: before that the node hangs up."""
        topic = self.name + '/' + topic
        wait_for(lambda: topic in [t for t, _ in self.master.getPublishedTopics('/test', '')[2]],
                 topic)
        return Subscriber(self.uri(), topic, kind, **options)

    def resident(self):
        with open('/proc/%d/statm' % self.process.pid) as f:
            return int(f.read().split()[1]) * os.sysconf('SC_PAGE_SIZE')

    def end(self, how=signal.SIGINT):
        """Status and seconds after the signal."""
        begin = time.monotonic()
        self.process.send_signal(how)
        status = self.process.wait(LIMIT)
        return status, time.monotonic() - begin

    def kill(self):
        if self.process.poll() is None:
            self.process.kill()
            self.process.wait()


class Roscore:
    def __init__(self, port):
        self.uri = 'http://127.0.0.1:%d' % port
        self.process = subprocess.Popen(['rosmaster', '--core', '-p', str(port)],
                                        stdout=subprocess.DEVNULL)
        wait_for(self.answers, 'a master')

    def answers(self):
        try:
            return ServerProxy(self.uri).getPid('/test')[0] == 1
        except OSError:
            return False

    def kill(self):
        self.process.kill()
        self.process.wait()


class Relay:
    """A master in front of another: before it passes on a call of registering, it does something."""

    def __init__(self, master, before):
        self.master, self.before, self.lock = ServerProxy(master), before, threading.Lock()
        self.server = SimpleXMLRPCServer(('127.0.0.1', 0), logRequests=False)
        self.server.register_instance(self)
        self.uri = 'http://127.0.0.1:%d' % self.server.server_address[1]
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def _dispatch(self, method, arguments):
        if method in ('registerPublisher', 'registerService'):
            self.before(arguments[1])
        return getattr(self.master, method)(*arguments)

    def end(self):
        self.server.shutdown()
        self.server.server_close()


def free_port():
    with socket.socket() as s:
        s.bind(('127.0.0.1', 0))
        return s.getsockname()[1]


def keeps_pace(time_of_state):
    """Simulated seconds are real ones, in one window of several: a busy machine spoils some."""
    def window():
        begin, first = time.monotonic(), time_of_state()
        time.sleep(0.3)
        last = time_of_state()
        return abs((last - first) / (time.monotonic() - begin) - 1) < 0.1
    return wait_for(window, 'a simulation at its pace')


# roslaunch of Debian 11 has it whenever it is interrupted.
OF_ROSLAUNCH = re.compile(r"""Traceback.*\n  File ".*/roslaunch/pmon\.py".*\n.*\nAttributeError: .* 'isAlive'\n""")


class FaultsTest(unittest.TestCase):
    def start(self, name, **parameters):
        node = Node(name, **parameters)
        self.addCleanup(node.kill)
        return node

    def test_a_clock_that_ends_leaves_use_sim_time_as_it_was(self):
        core = Roscore(free_port())
        self.addCleanup(core.kill)
        master = ServerProxy(core.uri)

        def there():
            code, _, value = master.getParam('/test', '/use_sim_time')
            return value if code == 1 else None
        for before, how in ((None, signal.SIGINT), (None, signal.SIGTERM), (False, signal.SIGINT),
                            (True, signal.SIGINT)):
            if before is not None:
                master.setParam('/test', '/use_sim_time', before)
            node = self.start('clock', master=core.uri, publish_clock='true')
            wait_for(lambda: master.lookupService('/test', '/clock/reset')[0] == 1, 'the node')
            self.assertTrue(there())
            self.assertEqual(node.end(how)[0], 0)
            self.assertIs(there(), before)

    def test_a_clock_that_was_killed_leaves_use_sim_time_to_the_next_one(self):
        core = Roscore(free_port())
        self.addCleanup(core.kill)
        master = ServerProxy(core.uri)
        for before in (None, False):
            if before is not None:
                master.setParam('/test', '/use_sim_time', before)
            for name, how in (('killed', signal.SIGKILL), ('next', signal.SIGINT)):
                node = self.start('%s_%s' % (name, before), master=core.uri, publish_clock='true')
                node.service('reset', Trigger)
                self.assertTrue(master.getParam('/test', '/use_sim_time')[2])
                node.end(how)
            there, _, value = master.getParam('/test', '/use_sim_time')
            self.assertIs(value if there == 1 else None, before)
        # Nothing is kept for a third one, and what someone sets meanwhile stays.
        self.assertEqual([n for n in master.getParamNames('/test')[2] if 'ragdoll' in n], [])
        node = self.start('third', master=core.uri, publish_clock='true')
        node.service('reset', Trigger)
        master.deleteParam('/test', '/use_sim_time')
        node.end()
        self.assertFalse(master.hasParam('/test', '/use_sim_time')[2])

    def test_two_clocks_are_told_and_the_last_one_takes_use_sim_time_away(self):
        self.assertFalse(rospy.has_param('/use_sim_time'))
        self.addCleanup(lambda: rospy.has_param('/use_sim_time') and rospy.delete_param('/use_sim_time'))
        log = Inbox('/rosout', Log)
        first, second = (self.start(name, scene='fall', publish_clock='true', tf_bodies='none')
                         for name in ('tick', 'tock'))
        reports = Inbox('/diagnostics', DiagnosticArray)
        for node, other in ((first, second), (second, first)):
            told = reports.first(lambda m: node.name[1:] + ':' in m.status[0].name and
                                 '/clock is published by ' + other.name in m.status[0].message,
                                 'a warning of ' + other.name)
            self.assertEqual(told.status[0].level, DiagnosticStatus.WARN)
            log.first(lambda m: m.name == node.name and m.msg.startswith(other.name + ' publishes /clock'),
                      'a line of ' + other.name)
        self.assertEqual(first.end()[0], 0)
        self.assertIs(rospy.get_param('/use_sim_time'), True)  # of the second, which goes on
        seen = len(reports.all())
        wait_for(lambda: any(second.name[1:] + ':' in m.status[0].name and
                             first.name not in m.status[0].message for m in reports.all()[seen:]),
                 'the end of the warning')
        self.assertEqual(second.end()[0], 0)
        self.assertFalse(rospy.has_param('/use_sim_time'))
        # One that fails at its start does not end the clock of another.
        first = self.start('tick', scene='fall', publish_clock='true', tf_bodies='none')
        first.service('reset', Trigger)
        failed = self.start('failed', scene='nowhere', publish_clock='true')
        self.assertEqual(failed.process.wait(LIMIT), 1)
        self.assertIs(rospy.get_param('/use_sim_time'), True)
        self.assertEqual(first.end()[0], 0)
        self.assertFalse(rospy.has_param('/use_sim_time'))

    def test_a_listener_that_stops_reading_many_bodies_takes_little_memory(self):
        """With ~publish_every, too, whose queue is of 10000 messages of few bodies; and markers, of which a
        picture of so many has 36 MB."""
        scene = 'gravity: [0, 0, 0]\nsolver: {preset: fast}\nragdolls:\n' + ''.join(
            '  - {name: r%d, model: human, position: [%d, 0, 1]}\n' % (i, 2 * i) for i in range(100))
        node = self.start('many', scene=scene, publish_every=1 / 60, realtime_factor=-1,
                          tf_bodies='none')
        topics = {'state': State, 'joint_states': JointState, 'markers': MarkerArray}
        deaf = [node.subscriber(name, kind, buffer=4096) for name, kind in topics.items()]
        get = node.service('get_state', GetState)
        first = get.call().state.step
        # 0.2 MB of state and joints a step, and 8 MB of each picture, were all of them kept.
        wait_for(lambda: get.call().state.step > first + 1000, 'steps')
        if 'RAGDOLL_SANITIZED' not in os.environ:
            self.assertLess(node.resident(), 200e6)
        # Another scene has its own queue, and who listened hears of it.
        self.assertTrue(node.service('load_scene', LoadScene).call(path='fall').success)
        client = Client(node.name)
        client.states.first(lambda m: len(m.ragdolls) == 1, 'a state of one body')
        self.assertEqual(node.end()[0], 0)
        for subscriber in deaf:
            subscriber.close()

    def test_a_listener_that_never_reads_delays_nobody(self):
        node = self.start('unread', scene='weightless', publish_rate=500)
        client = Client(node.name)
        deaf = [node.subscriber('state', State, buffer=4096) for _ in range(3)]
        first = wait_for(lambda: client.states.all() and client.states.all()[-1], 'a state')
        # More than the sockets and the queue of 100 messages hold: what is older is dropped.
        wait_for(lambda: client.states.all()[-1].step > first.step + 500, 'states')
        before = node.resident()
        wait_for(lambda: client.states.all()[-1].step > first.step + 2000, 'states')
        if 'RAGDOLL_SANITIZED' not in os.environ:  # sanitizers keep what is freed
            self.assertLess(node.resident() - before, 20e6)
        keeps_pace(lambda: client.call_get().state.time)
        self.assertEqual(node.end()[0], 0)
        for subscriber in deaf:
            subscriber.close()

    def test_a_bag_at_full_rate_has_every_poke_and_the_last_state(self):
        node = self.start('recorded', scene='weightless', publish_rate=1000, start_paused='true')
        client = Client(node.name)
        folder = tempfile.mkdtemp()
        self.addCleanup(shutil.rmtree, folder)
        topics = [node.name + '/' + t for t in ('state', 'pokes', 'model')] + ['/tf']
        recorder = Recorder(os.path.join(folder, 'full.bag'), node.name, topics)
        client.call_pause(False)
        told = [client.poke('head', force=(i, 0, 0)).status_message for i in range(1, 101)]
        keeps_pace(lambda: client.call_get().state.time)
        client.call_pause(True)
        last = client.at(client.call_get().state.step)
        recorder.stop_after([last, client.pokes.first(lambda m: m.force.x == 100, 'the last poke')])
        pokes, states = {}, []
        with rosbag.Bag(recorder.path) as bag:
            for topic, message, _ in bag.read_messages():
                if topic.endswith('/pokes'):
                    pokes.setdefault(message.force.x, []).append(message.step)
                if topic.endswith('/state'):
                    states.append(message)
        self.assertEqual(pokes, {float(i + 1): [int(text.split('from step ')[1].split()[0])]
                                 for i, text in enumerate(told)})
        self.assertEqual(bits(states[-1]), bits(last))
        self.assertTrue(all(a.step <= b.step for a, b in zip(states, states[1:])))

    def test_without_its_master_the_node_goes_on(self):
        master = Roscore(free_port())
        self.addCleanup(lambda: master.kill())
        node = self.start('orphan', master=master.uri, scene='weightless')
        states = node.subscriber('state', State)
        get = node.service('get_state', GetState)
        load = node.service('load_scene', LoadScene)
        step, pause = node.service('step', Step), node.service('pause', SetBool)
        begun = states.next()

        master.kill()
        wait_for(lambda: states.next().step > begun.step + 100, 'steps without a master')
        keeps_pace(lambda: get.call().state.time)
        self.assertTrue(load.call(path='hang').success)
        self.assertTrue(pause.call(data=True).success)
        self.assertEqual(step.call(steps=3).step - get.call().state.step, 0)
        self.assertTrue(pause.call(data=False).success)

        master = Roscore(int(master.uri.split(':')[-1]))
        # Who is connected stays connected; the new master knows nothing of the node, as roscpp
        # registers once, so that nobody new finds it.
        reached = get.call().state.step
        wait_for(lambda: states.next().step > reached + 100, 'steps with another master')
        self.assertTrue(load.call(path='fall').success)
        # Only topics of a scene that is loaded now are new to it.
        known = ServerProxy(master.uri).lookupService('/test', node.name + '/poke')
        self.assertEqual(known[0], -1)
        self.assertEqual(node.end()[0], 0)
        # Started again it is found again.
        again = self.start('orphan', master=master.uri, scene='weightless')
        self.assertGreater(again.service('get_state', GetState).call().state.time, -1)
        self.assertEqual(again.end()[0], 0)

    def test_interrupted_in_mid_step_it_ends_by_itself(self):
        node = self.start('busy', scene='crowd', realtime_factor=-1)
        Client(node.name)
        status, seconds = node.end()
        print('interrupted in mid-step: ended after %.3f s' % seconds)
        self.assertEqual(status, 0)

    def test_interrupted_while_nothing_moves_it_ends_by_itself(self):
        core = Roscore(free_port())
        self.addCleanup(core.kill)
        for name, sim_time, parameters in (('paused', False, {'start_paused': 'true'}),
                                           ('waiting', True, {})):
            ServerProxy(core.uri).setParam('/test', '/use_sim_time', sim_time)  # without a clock
            node = self.start(name, master=core.uri, **parameters)
            self.assertEqual(node.service('get_state', GetState).call().state.step, 0)
            self.assertEqual(node.end()[0], 0)

    def test_interrupted_while_it_starts_it_ends_by_itself(self):
        for how in (signal.SIGINT, signal.SIGTERM):
            for last in ('parameter_descriptions', 'model', 'clock', 'pause'):
                registered = []

                def before(name):
                    again = name in registered  # a signal may end a call, which is then repeated
                    registered.append(name)
                    if name.split('/')[-1] == last and not again:
                        node.process.send_signal(how)
                        time.sleep(0.3)  # until ROS has seen that it is to end; it looks every 0.1 s
                relay = Relay(os.environ['ROS_MASTER_URI'], before)
                self.addCleanup(relay.end)
                node = self.start('starting', master=relay.uri, publish_clock='true')
                self.assertEqual(node.process.wait(LIMIT), 0, registered)

    def test_interrupted_in_a_long_call_it_ends_by_itself(self):
        node = self.start('stepping', scene='crowd', start_paused='true')
        step = node.service('step', Step)
        get = node.service('get_state', GetState)
        caller = threading.Thread(target=self.expect_no_answer, args=(step,))
        caller.start()
        wait_for(lambda: get.call().state.step > 0, 'steps')
        status, seconds = node.end()
        caller.join()
        print('interrupted in a call of 1e7 steps: ended after %.3f s' % seconds)
        self.assertEqual(status, 0)

    def expect_no_answer(self, step):
        try:
            self.assertFalse(step.call(steps=10000000).success)
        except (AssertionError, EOFError, OSError):
            pass  # the connection ends with the node

    def test_a_scene_file_that_is_gone_is_not_needed(self):
        folder = tempfile.mkdtemp()
        path = os.path.join(folder, 'mine.yaml')
        shutil.copy(os.path.join(SCENES, 'fall.yaml'), path)
        node = self.start('forgetful', scene=path, start_paused='true')
        client = Client(node.name)
        start = client.restart()
        client.step(10)
        shutil.rmtree(folder)
        again = client.restart()
        self.assertEqual(bits(again), bits(start))
        before = client.call_get().snapshot
        answer = client.service('load_scene', LoadScene)(path, '')
        self.assertFalse(answer.success)
        self.assertIn(path, answer.status_message)
        self.assertEqual(client.call_get().snapshot, before)
        self.assertEqual(node.end()[0], 0)

    def launch(self, *arguments):
        """roslaunch with a master of its own, and what it says."""
        port = free_port()
        log = tempfile.NamedTemporaryFile('w')
        environment = dict(os.environ, ROS_MASTER_URI='http://127.0.0.1:%d' % port)
        launch = subprocess.Popen(['roslaunch', '-p', str(port), 'ragdoll'] + list(arguments),
                                  stdout=log, stderr=subprocess.STDOUT, env=environment)
        self.addCleanup(lambda: launch.poll() is None and launch.kill())

        def said():
            with open(log.name) as f:
                return f.read()
        return launch, said, ServerProxy(environment['ROS_MASTER_URI'])

    def test_the_demo_of_pushing_ends_after_its_rounds(self):
        launch, said, _ = self.launch('push.launch', 'rviz:=false', 'rounds:=1', 'speed:=10')
        launch.wait(LIMIT)
        self.assertNotIn('Traceback', OF_ROSLAUNCH.sub('', said()))
        self.assertNotIn('SIGKILL', said())

    def test_the_demo_of_pushing_ends_when_it_is_interrupted(self):
        for rounds in ('0', '1'):
            self.interrupt_push(rounds)

    def interrupt_push(self, rounds):
        launch, said, master = self.launch('push.launch', 'rviz:=false', 'rounds:=' + rounds)

        def moves():
            try:
                return master.lookupNode('/test', '/push')[0] == 1 and [
                    t for t, _ in master.getPublishedTopics('/test', '')[2] if t == '/tf']
            except OSError:
                return False
        wait_for(moves, 'the gripper')
        launch.send_signal(signal.SIGINT)
        launch.wait(LIMIT)
        self.assertNotIn('Traceback', OF_ROSLAUNCH.sub('', said()))
        self.assertNotIn('escalating', said())  # as roslaunch does with what does not end by itself

    def test_two_nodes_that_publish_the_same_frames_are_told(self):
        first, second = self.start('first', scene='fall'), self.start('second', scene='fall')
        reports = Inbox('/diagnostics', DiagnosticArray)
        for node, other in ((first, second), (second, first)):
            words = other.name + ' publishes '
            told = reports.first(lambda m: node.name[1:] in m.status[0].name and
                                 words in m.status[0].message, 'a warning of ' + other.name)
            self.assertIn('ragdoll/', told.status[0].message)
            self.assertIn('~frame_prefix', told.status[0].message)
        self.assertEqual(second.end()[0], 0)
        end = rospy.Time.now()
        reports.first(lambda m: m.header.stamp > end and first.name[1:] in m.status[0].name and
                      second.name not in m.status[0].message, 'the end of the warning')


if __name__ == '__main__':
    rospy.init_node('faults_test')
    rostest.rosrun('ragdoll_sim', 'faults', FaultsTest, sys.argv)
