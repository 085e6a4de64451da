"""What the python rostests of bags share: recording them, and what is in them."""

import atexit
import io
import os
import signal
import subprocess
from xmlrpc.client import ServerProxy

import rosbag
import rosgraph
import roslib.packages
from client import LIMIT, wait_for


def serialized(message):
    out = io.BytesIO()
    message.serialize(out)
    return out.getvalue()


def contents(path):
    """All messages of a bag as bytes, with topic and time."""
    with rosbag.Bag(path) as bag:
        return [(topic, t, serialized(message)) for topic, message, t in bag.read_messages()]


class Recorder:
    """rosbag record, from the moment on at which it hears a node's topics."""

    def __init__(self, path, node, topics):
        self.path, self.topics = path, set(topics)
        self.uri = rosgraph.Master('/recorder').lookupNode(node)
        self.node = ServerProxy(self.uri)
        program = roslib.packages.find_node('rosbag', 'record')[0]
        self.process = subprocess.Popen([program, '--quiet', '-O', path] + topics)
        atexit.register(self.process.kill)  # a test that failed leaves nothing behind
        wait_for(self.is_connected, 'the recorder')

    def is_connected(self):
        """Whether the node's connections (number, callerid, direction, transport, topic, ...) show the
        recorder on all topics."""
        return {c[4] for c in self.node.getBusInfo('/recorder')[2]
                if c[1].startswith('/record')} >= self.topics

    def stop(self):
        """Once the recorder has dealt with all that the node has sent by now: both rest."""
        pids = [self.node.getPid('/recorder')[2], self.process.pid]
        wait_for(lambda: rest(pids), 'the node and the recorder to rest')
        self.process.send_signal(signal.SIGINT)
        self.process.wait(LIMIT)
        wait_for(lambda: os.path.exists(self.path), 'the bag')


def rest(pids):
    """Whether none of the processes' threads has had anything to do for a moment, however busy the
    machine is: who hands something over and then sleeps has woken another, which shows in one look or in
    the next."""
    first = threads(pids)
    return all(state == 'S' for state, _ in first.values()) and threads(pids) == first


def threads(pids):
    """Of each thread its state, and how often it has given up its core."""
    out = {}
    for pid in pids:
        for thread in os.listdir('/proc/%d/task' % pid):
            try:
                with open('/proc/%d/task/%s/status' % (pid, thread)) as file:
                    lines = dict(line.split(':', 1) for line in file)
            except (FileNotFoundError, ProcessLookupError):
                continue  # it has just ended
            out[thread] = (lines['State'].split()[0], lines['voluntary_ctxt_switches'])
    return out
