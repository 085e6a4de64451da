"""TCPROS without a ROS node around it: clients that need no master once they know the server, and
clients that misbehave. Format: https://wiki.ros.org/ROS/TCPROS"""

import io
import socket
import struct
from urllib.parse import urlparse
from xmlrpc.client import ServerProxy

from client import LIMIT


def header(**fields):
    parts = [('%s=%s' % item).encode() for item in fields.items()]
    body = b''.join(struct.pack('<I', len(part)) + part for part in parts)
    return struct.pack('<I', len(body)) + body


class Connection:
    def __init__(self, address, buffer=None, **fields):
        self.socket = socket.socket()
        if buffer:  # to be set before the connection is made
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, buffer)
        self.socket.settimeout(LIMIT)
        self.socket.connect(address)
        self.socket.sendall(header(callerid='/raw', **fields))

    def read(self, size):
        data = b''
        while len(data) < size:
            more = self.socket.recv(size - len(data))
            if not more:
                raise EOFError('the other side has hung up')
            data += more
        return data

    def read_block(self):
        return self.read(struct.unpack('<I', self.read(4))[0])

    def close(self):
        self.socket.close()


class Subscriber(Connection):
    """Of one topic of the node with this slave URI."""

    def __init__(self, node_uri, topic, kind, buffer=None):
        code, message, protocol = ServerProxy(node_uri).requestTopic('/raw', topic, [['TCPROS']])
        assert code == 1 and protocol, message
        super().__init__((protocol[1], protocol[2]), buffer=buffer, topic=topic, type=kind._type,
                         md5sum=kind._md5sum)
        self.kind = kind
        answer = self.read_block()  # the publisher's header
        assert b'error=' not in answer, answer

    def next(self):
        message = self.kind()
        message.deserialize(self.read_block())
        return message


class Service(Connection):
    """A persistent connection to a service with this rosrpc:// URI."""

    def __init__(self, uri, name, kind):
        place = urlparse(uri)
        super().__init__((place.hostname, place.port), service=name, md5sum=kind._md5sum,
                         persistent=1)
        self.kind = kind
        self.read_block()

    def call(self, **fields):
        data = io.BytesIO()
        self.kind._request_class(**fields).serialize(data)
        self.socket.sendall(struct.pack('<I', len(data.getvalue())) + data.getvalue())
        assert self.read(1) == b'\1', self.read_block()
        response = self.kind._response_class()
        response.deserialize(self.read_block())
        return response
