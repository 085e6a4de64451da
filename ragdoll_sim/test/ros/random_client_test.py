#!/usr/bin/python3
"""A seeded client that asks for anything at all: nothing that is refused changes the state, every
refusal says something, nothing grows, and the node lives."""

import hashlib
import math
import os
import random
import sys
import unittest

import dynamic_reconfigure.client
import rosgraph
import rospy
import rostest
from client import LIMIT, Client, wait_for
from geometry_msgs.msg import Point, Quaternion, TransformStamped, Vector3, WrenchStamped
from ragdoll_msgs.msg import PokeEvent
from ragdoll_msgs.srv import (Attach, Detach, GetState, LoadScene, Poke, PokeRequest, SetState,
                              Step)
from tf2_msgs.msg import TFMessage
from visualization_msgs.msg import InteractiveMarkerFeedback
from xmlrpc.client import ServerProxy

LAST = 0.640625  # [N] of a poke that no other one looks like
CALLS = int(os.environ.get('RAGDOLL_CALLS', 3000))
SEED = int(os.environ.get('RAGDOLL_SEED', 20250705))
GROWTH = 64e6  # [B] of resident memory over all calls; a leak of 1 kB a call would be 100 MB
LONGEST = 10000  # [B] of a message

NUMBERS = [0.0, 1.0, -1.0, 50.0, math.nan, math.inf, -math.inf, 1e9, -1e9, 1e160, 1e-320]
HUGE = [1e17, -1e17, 1e308]  # [N] more than numbers can follow
NAMES = ['head', 'torso', 'ragdoll/left_hand', 'ragdoll/head', 'right_forearm', '', '/', 'nobody',
         'nobody/head', 'ragdoll/', 'head/head', 'x' * 100000, '\n', '\x01', 'ragdöll', '*', '~']
FRAMES = ['', 'world', '/world', 'ragdoll/head', 'nowhere', '/', '//', 'y' * 100000, 'a b', '\t']
TEXTS = ['', 'ragdolls: []', 'ragdolls: [{model: human, count: 1e9}]', '[' * 1000, '\x00', '- a',
         'ragdolls: [{model: nobody}]', 'z' * 1000000, 'ragdolls: [{model: human}]\nstep: 1',
         'ragdolls: [{model: human}]\ngravity: [.nan, 0, 0]', '&a [*a]',
         'ragdolls: [{model: human}]\nsolver: {step: 0}']
PATHS = ['', '/', '/dev/zero', '/nowhere.yaml', 'package://', 'package://nobody/x.yaml', 'stiars',
         '../../../etc/passwd', 'w' * 100000]


class RandomClientTest(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.client = Client()
        cls.random = random.Random(SEED)
        cls.load = cls.persistent('load_scene', LoadScene)
        cls.set = cls.persistent('set_state', SetState)
        cls.attach = cls.persistent('attach', Attach)
        cls.detach = cls.persistent('detach', Detach)
        cls.client.call_get = cls.persistent('get_state', GetState)
        cls.client.call_poke = cls.persistent('poke', Poke)
        cls.client.call_step = cls.persistent('step', Step)
        cls.settings = dynamic_reconfigure.client.Client('/ragdoll', timeout=LIMIT)
        cls.wrench = rospy.Publisher('/ragdoll/wrench', WrenchStamped, queue_size=100)
        cls.replay = rospy.Publisher('/ragdoll/poke_replay', PokeEvent, queue_size=100)
        cls.handle = rospy.Publisher('/ragdoll/handles/feedback', InteractiveMarkerFeedback,
                                     queue_size=100)
        cls.tf = rospy.Publisher('/tf', TFMessage, queue_size=100)
        for publisher in (cls.wrench, cls.replay, cls.handle, cls.tf):
            wait_for(publisher.get_num_connections, 'a subscriber of ' + publisher.name)
        node = rosgraph.Master('/test').lookupNode('/ragdoll')
        cls.pid = ServerProxy(node).getPid('/test')[2]

    @staticmethod
    def persistent(name, kind):
        """One connection for all calls: many times as fast."""
        rospy.wait_for_service('/ragdoll/' + name, LIMIT)
        return rospy.ServiceProxy('/ragdoll/' + name, kind, persistent=True)

    def number(self):
        return self.random.choice(NUMBERS)

    def triple(self):
        return [self.number() if self.random.random() < 0.3 else self.random.uniform(-50, 50)
                for _ in range(3)]

    def force(self):
        force = self.triple()
        if self.random.random() < 0.3:
            force[self.random.randrange(3)] = self.random.choice(HUGE)
        return force

    def moment(self):
        snapshot = self.client.call_get().snapshot
        return hashlib.sha1(snapshot).hexdigest()

    def resident(self):
        with open('/proc/%d/statm' % self.pid) as f:
            return int(f.read().split()[1]) * os.sysconf('SC_PAGE_SIZE')

    # One request of each kind; returns success and message where the service has them.

    def ask_poke(self):
        a = self.client.call_poke(PokeRequest(
            body_name=self.random.choice(NAMES), reference_frame=self.random.choice(FRAMES),
            force=Vector3(*self.force()), reference_point=Point(*self.triple()),
            start_time=rospy.Time(self.random.choice([0, 1, 2**32 - 1]), 999999999),
            duration=rospy.Duration(self.random.choice([0, 1, -1, -2**31, 2**31 - 1]), 999999999)))
        return a.success, a.status_message

    def ask_load(self):
        yaml, path = self.random.choice(TEXTS), self.random.choice(PATHS)
        a = self.load(*self.random.choice([(path, ''), ('', yaml), (path, yaml)]))
        return a.success, a.status_message

    def ask_set(self):
        data = bytearray(self.client.call_get().snapshot)
        kind = self.random.randrange(4)
        if kind == 0:
            data = data[:self.random.randrange(len(data))]
        elif kind == 1:
            data[self.random.randrange(len(data))] ^= 1 << self.random.randrange(8)
        elif kind == 2:
            data = bytes(self.random.randrange(256) for _ in range(self.random.randrange(100)))
        else:
            data += bytes(self.random.randrange(1, 1000000))
        a = self.set(bytes(data))
        self.assertFalse(a.success)
        return a.success, a.status_message

    def ask_attach(self):
        a = self.attach(self.random.choice(NAMES), self.random.choice(FRAMES[3:]))
        return a.success, a.status_message

    def ask_detach(self):
        a = self.detach(self.random.choice(NAMES))
        return a.success, a.status_message

    def ask_step(self):
        a = self.client.call_step(self.random.choice([0, 1, 3, 10000001, 2**32 - 1]))
        return a.success, a.status_message

    def ask_clear(self):
        a = self.client.call_clear()
        return a.success, a.message

    def ask_reset(self):
        a = self.client.call_reset()
        return a.success, a.message

    def ask_pause(self):
        a = self.client.call_pause(True)
        return a.success, a.message

    def test_nothing_refused_changes_anything(self):
        asks = [self.ask_poke] * 6 + [self.ask_set, self.ask_attach, self.ask_detach,
                                      self.ask_step, self.ask_load] * 2 + [
                                          self.ask_clear, self.ask_reset, self.ask_pause]
        self.client.restart()
        before, refused, too_strong, start = self.moment(), 0, 0, None
        for i in range(CALLS):
            ask = self.random.choice(asks)
            success, message = ask()
            after = self.moment()
            self.assertTrue(message.strip(), ask.__name__)
            self.assertLess(len(message), LONGEST, ask.__name__)
            if not success:
                refused += 1
                too_strong += 'numbers cannot follow' in message
                self.assertEqual(after, before, '%s: %s' % (ask.__name__, message))
            before = after
            if i % 500 == 0:  # memory that one call fills is given back; what stays counts
                self.client.states.messages.clear()
                self.client.pokes.messages.clear()
                start = start or (i >= CALLS // 10 and self.resident())
        self.assertGreater(refused, CALLS // 4)
        self.assertLess(refused, CALLS)
        self.assertGreater(too_strong, CALLS // 1000)
        state = self.client.call_get().state
        self.assertTrue(all(math.isfinite(c) for r in state.ragdolls for p in r.positions
                            for c in (p.x, p.y, p.z)))
        grown = self.resident() - start
        print('%d calls, %d refused, %d for their force, grown by %d kB' %
              (CALLS, refused, too_strong, grown // 1000))
        if 'RAGDOLL_SANITIZED' not in os.environ:  # sanitizers keep memory, and find leaks themselves
            self.assertLess(grown, GROWTH)

    def test_topics_take_anything(self):
        """What is wrong is ignored: one poke is there at the end, and the state is as at the start."""
        self.client.restart()
        before = self.moment()
        bad = [v for v in NUMBERS if not math.isfinite(v)]
        for i in range(CALLS // 10):
            wrench = WrenchStamped()
            wrench.header.frame_id = self.random.choice([f for f in FRAMES if 'head' not in f])
            wrench.wrench.force = Vector3(*self.triple())
            self.wrench.publish(wrench)
            wrench.header.frame_id = 'ragdoll/head'
            wrench.wrench.torque = Vector3(self.random.choice(bad), 0, 0)
            self.wrench.publish(wrench)
            wrench.wrench.force = Vector3(z=self.random.choice(HUGE))
            wrench.wrench.torque = Vector3()
            self.wrench.publish(wrench)
            self.replay.publish(PokeEvent(body_name='head', step=i, force=wrench.wrench.force))
            event = PokeEvent(body_name=self.random.choice(['nobody', 'x' * 1000, '/']),
                              step=self.random.choice([0, 1, 2**64 - 1]))
            self.replay.publish(event)
            self.replay.publish(PokeEvent(body_name='head', step=2**64 - 1))
            self.replay.publish(PokeEvent(body_name='head', force=Vector3(0, 0, bad[i % 3])))
            feedback = InteractiveMarkerFeedback(event_type=self.random.randrange(256))
            feedback.marker_name = self.random.choice(['', 'nobody', 'ragdoll/head'])
            feedback.header.frame_id = self.random.choice(FRAMES)
            feedback.pose.position = Point(self.random.choice(bad), self.number(), 0)
            self.handle.publish(feedback)
            frame = TransformStamped(child_frame_id=self.random.choice(FRAMES))
            frame.header.frame_id = self.random.choice(FRAMES)
            frame.header.stamp = rospy.Time(self.random.choice([0, 1, 2**32 - 1]), 999999999)
            frame.transform.translation = Vector3(*self.triple())
            frame.transform.rotation = self.random.choice(
                [Quaternion(w=1), Quaternion(*(self.number() for _ in range(4)))])
            self.tf.publish(TFMessage([frame]))
        # What has been sent is handled before what comes now: a poke that is told.
        self.replay.publish(PokeEvent(body_name='head', step=5, force=Vector3(x=LAST)))
        self.client.pokes.first(lambda m: m.force.x == LAST, 'the last poke')
        self.assertEqual(self.client.call_clear().message, '1 poke ended')
        self.assertEqual(self.moment(), before)

    def test_settings_take_anything(self):
        self.client.restart()
        for _ in range(CALLS // 100):
            knob, value = self.random.choice([
                ('preset', self.random.choice(['none', '', 'x' * 1000])),
                ('step', self.number()), ('tolerance', self.number()), ('damping', self.number()),
                ('gravity_x', self.number()), ('realtime_factor', self.number()),
                ('sweeps', self.random.choice([-2**31, 0, 2**31 - 1])),
                ('method', self.random.choice([-1, 7])), ('integrator', self.random.choice([-1, 99]))])
            told = self.settings.update_configuration({knob: value})
            self.assertTrue(math.isfinite(told['step']) and told['step'] > 0, told)
            self.assertTrue(math.isfinite(told['gravity_x']), told)
            self.assertTrue(told['realtime_factor'] > 0 or told['realtime_factor'] == -1, told)
            self.assertTrue(0 <= told['method'] <= 2 and 0 <= told['integrator'] <= 4, told)
        before = self.moment()
        told = self.settings.update_configuration({'gravity_z': math.nan, 'show_limits': True})
        self.assertEqual(self.moment(), before)
        self.assertFalse(told['show_limits'])  # all or nothing
        self.settings.update_configuration({'preset': 'thesis', 'realtime_factor': 1.0})
        self.settings.update_configuration({'preset': 'balanced', 'gravity_x': 0.0})

    def test_zz_is_alive_at_the_end(self):
        self.client.restart()
        self.assertTrue(self.client.call_pause(False).success)
        step = self.client.call_get().state.step
        wait_for(lambda: self.client.call_get().state.step > step + 50, 'steps')


if __name__ == '__main__':
    rospy.init_node('random_client_test')
    rostest.rosrun('ragdoll_sim', 'random_client', RandomClientTest, sys.argv)
