"""Pretends to be a TDW build with libzmq's own REQ socket, and prints what the controller sends to it.

Usage: pretend_build.py PORT
"""

import json
import sys

import zmq

socket = zmq.Context().socket(zmq.REQ)
socket.connect(f"tcp://127.0.0.1:{sys.argv[1]}")
socket.send(b"anything")
version = b"\0\0\0\0vers\x01\x081.13.0.02020.3.24f1"
for number in range(3):
    (text,) = socket.recv_multipart()
    kinds = [command["$type"] for command in json.loads(text)]
    print(json.dumps([len(text), kinds[:2]]))
    large = [b"\0\0\0\0huge" + bytes(1 << 20)] if number == 1 else []
    answer = [b"\0\0\0\0ftre", bytes(4)] if number == 0 else [version, *large, number.to_bytes(4, "big")]
    socket.send_multipart(answer)
