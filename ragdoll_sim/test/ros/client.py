"""What the python rostests share: the node's services, its messages, waiting for conditions."""

import os
import signal
import struct
import subprocess
import threading
import time

import roslib.packages
import rospy
from geometry_msgs.msg import Point, Vector3
from ragdoll_msgs.msg import Model, PokeEvent, State
from ragdoll_msgs.srv import GetState, LoadScene, Poke, PokeRequest, Step
from std_srvs.srv import SetBool, Trigger

# [s] a test that waits longer than this has failed
LIMIT = 300.0 if 'RAGDOLL_SANITIZED' in os.environ else 30.0


def wait_for(condition, what):
    """Returns the first value of condition() that is true."""
    end = time.monotonic() + LIMIT
    while time.monotonic() < end:
        value = condition()
        if value:
            return value
        time.sleep(0.005)
    raise AssertionError('waited %g s in vain for %s' % (LIMIT, what))


class Inbox:
    """All messages of a topic, in order."""

    def __init__(self, topic, kind):
        self.lock = threading.Lock()
        self.messages = []
        self.subscriber = rospy.Subscriber(topic, kind, self.add, queue_size=None)
        wait_for(lambda: self.subscriber.get_num_connections() > 0, 'a publisher of ' + topic)

    def add(self, message):
        with self.lock:
            self.messages.append(message)

    def all(self):
        with self.lock:
            return list(self.messages)

    def reader(self):
        """Of all messages, too, but each call gives only those since the last one."""
        read = 0

        def new():
            nonlocal read
            with self.lock:
                messages = self.messages[read:]
            read += len(messages)
            return messages
        return new

    def first(self, condition, what):
        """The condition is of the message alone: it is asked once."""
        new = self.reader()
        return wait_for(lambda: next((m for m in new() if condition(m)), None), what)


PROGRAM = roslib.packages.find_node('ragdoll_sim', 'ragdoll_node')[0]


def start_node(test, name, **parameters):
    """Its Client; a node of its own that ends with the test."""
    node = subprocess.Popen([PROGRAM, '__name:=' + name] +
                            ['_%s:=%s' % item for item in parameters.items()])

    def end():
        node.send_signal(signal.SIGINT)
        node.wait(LIMIT)
    test.addCleanup(end)
    return Client('/' + name)


class Client:
    def __init__(self, node='/ragdoll'):
        self.node = node
        self.models = Inbox(node + '/model', Model)
        self.models.first(lambda m: True, 'a model')
        self.marks = 0
        self.states = Inbox(node + '/state', State)
        self.pokes = Inbox(node + '/pokes', PokeEvent)
        self.call_poke = self.service('poke', Poke)
        self.call_step = self.service('step', Step)
        self.call_reset = self.service('reset', Trigger)
        self.call_clear = self.service('clear_pokes', Trigger)
        self.call_pause = self.service('pause', SetBool)
        self.call_get = self.service('get_state', GetState)
        self.call_load = self.service('load_scene', LoadScene)

    @property
    def model(self):
        return self.models.all()[-1]

    def service(self, name, kind):
        rospy.wait_for_service(self.node + '/' + name, LIMIT)
        return rospy.ServiceProxy(self.node + '/' + name, kind)

    def poke(self, body, force=(0, 0, 0), frame='', point=(0, 0, 0), start=0, duration=0.0):
        return self.call_poke(PokeRequest(
            body_name=body, reference_frame=frame, force=Vector3(*force),
            reference_point=Point(*point), start_time=rospy.Time(start),
            duration=rospy.Duration(duration)))

    def told(self):
        """All that ~pokes has told: topics come in any order, so a poke without force marks the end."""
        self.marks += 1
        mark = float(self.marks)
        body = self.model.ragdolls[0]
        answer = self.poke(body.name + '/' + body.particles[0], point=(mark, 0, 0))
        assert answer.success, answer.status_message
        self.pokes.first(lambda m: m.point.x == mark and m.force == Vector3(), 'a poke')
        return [m for m in self.pokes.all() if m.force != Vector3() or not m.body_name]

    def load(self, **scene):
        """Once this scene's model and first state are here."""
        answer = self.call_load(**scene)
        assert answer.success, answer.status_message
        run = self.call_get().state.run
        wait_for(lambda: self.model.run == run, 'the model')
        wait_for(lambda: self.states.all()[-1:] and self.states.all()[-1].run >= run, 'its state')
        return answer

    def step(self, steps):
        """The state after some steps; the node must be paused."""
        answer = self.call_step(steps)
        assert answer.success, answer.status_message
        return self.at(answer.step)

    def at(self, step):
        """The published state of this step, once it is out; the node must be paused there.

        The number alone would not do: another scene, or the same before a reset, has it too.
        """
        expected = self.call_get().state
        assert expected.step == step, 'the node is at step %d, not %d' % (expected.step, step)

        def latest():
            messages = self.states.all()
            return messages[-1] if messages and bits(messages[-1]) == bits(expected) else None
        return wait_for(latest, 'the state of step %d' % step)

    def restart(self):
        """Paused at the scene's start."""
        assert self.call_pause(True).success
        assert self.call_reset().success
        return self.at(0)


def bits(state):
    """Everything of a State that is physics, bit for bit."""
    out = [struct.pack('<Qd', state.step, state.time)]
    for ragdoll in state.ragdolls:
        for v in ragdoll.positions + ragdoll.velocities:
            out.append(struct.pack('<3d', v.x, v.y, v.z))
    return b''.join(out)


def momentum(model, state):
    """[kg m/s]"""
    sums = [0.0, 0.0, 0.0]
    for m, r in zip(model.ragdolls, state.ragdolls):
        for mass, v in zip(m.masses, r.velocities):
            sums = [s + mass * c for s, c in zip(sums, (v.x, v.y, v.z))]
    return sums


def position(model, state, particle, ragdoll=0):
    p = state.ragdolls[ragdoll].positions[model.ragdolls[ragdoll].particles.index(particle)]
    return (p.x, p.y, p.z)


def velocity(model, state, particle, ragdoll=0):
    v = state.ragdolls[ragdoll].velocities[model.ragdolls[ragdoll].particles.index(particle)]
    return (v.x, v.y, v.z)
