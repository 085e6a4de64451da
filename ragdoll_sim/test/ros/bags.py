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
        # Without chunks, what is recorded is in the file at once.
        self.process = subprocess.Popen([program, '--quiet', '--chunksize=0', '-O', path] + topics)
        atexit.register(self.process.kill)  # a test that failed leaves nothing behind
        wait_for(self.is_connected, 'the recorder')

    def connections(self):
        """Those of the node to the recorder: number, callerid, direction, transport, topic, ..."""
        return [c for c in self.node.getBusInfo('/recorder')[2] if c[1].startswith('/record')]

    def is_connected(self):
        """Whether the node's connections show the recorder on all topics."""
        return {c[4] for c in self.connections()} >= self.topics

    def stop_after(self, last):
        """Once these messages, as they were heard, are in the bag: however far behind the recorder is."""
        wait_for(lambda: self.has(last), 'the recorder to write the last messages')
        self.end()

    def has(self, wanted):
        with open(self.path + '.active', 'rb') as file:
            written = file.read()
        return all(serialized(message) in written for message in wanted)

    def stop(self):
        """Once the recorder has all that the node has sent by now, and has dealt with it."""
        connections = self.connections()
        recorder = ServerProxy(rosgraph.Master('/recorder').lookupNode(connections[0][1]))
        sent = messages(self.node, 0, {c[0] for c in connections}, 3)
        numbers = {c[0] for c in recorder.getBusInfo('/recorder')[2] if c[1] == self.uri}
        wait_for(lambda: messages(recorder, 1, numbers, 2) >= sent, 'the recorder to hear all')
        wait_for(lambda: sleeps(self.process.pid), 'the recorder to rest')
        self.end()

    def end(self):
        self.process.send_signal(signal.SIGINT)
        self.process.wait(LIMIT)
        wait_for(lambda: os.path.exists(self.path), 'the bag')


def messages(node, way, connections, column):
    """So many have gone through a roscpp node's connections out of (way 0) or into it (way 1)."""
    return sum(c[column] for topic in node.getBusStats('/recorder')[way] for c in topic[1]
               if c[0] in connections)


def sleeps(pid):
    """Whether none of a process's threads has anything to do, however busy the machine is."""
    try:
        for thread in os.listdir('/proc/%d/task' % pid):
            with open('/proc/%d/task/%s/stat' % (pid, thread)) as file:
                if file.read().rsplit(')', 1)[1].split()[0] != 'S':
                    return False
    except FileNotFoundError:
        return False  # a thread has just ended
    return True
