"""The program `wayword` as a module: exit codes, signals, child processes; and Ctrl-C inside a call."""

import json
import os
import pathlib
import signal
import subprocess
import sys
import time

import pytest

import wayword

# Seconds that tell these tests' processes from those of others.
SLEEP = 100_000 + os.getpid()
HERE = pathlib.Path(__file__).resolve().parent

# A world that never answers, in a child that starts a child of its own.
HANGS = """
import subprocess, sys, time
sys.path[:0] = {folders!r}
from wayword.platform import serve
from halls import Hall
class Slow(Hall):
    def observe(self, scene, look):
        time.sleep(600)
subprocess.Popen(["sleep", "{sleep}"])
serve(Slow)
"""


def slow_world(folder):
    (folder / "world.py").write_text(HANGS.format(sleep=SLEEP, folders=[str(HERE), str(HERE.parent)]))
    world = folder / "world.json"
    world.write_text(json.dumps({"command": [sys.executable, "world.py"]}))
    return world


def sleepers():
    found = subprocess.run(["pgrep", "-f", f"^sleep {SLEEP}$"], capture_output=True, text=True)
    return found.stdout.split()


def wait_for(is_so, seconds=20):
    end = time.time() + seconds
    while not is_so() and time.time() < end:
        time.sleep(0.05)
    return is_so()


def started(*arguments):
    typed = [sys.executable, "-m", "wayword", *map(str, arguments)]
    return subprocess.Popen(typed, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


def test_help_version_and_exit_codes(cli, tmp_path):
    told = cli("--version")
    assert (told.returncode, told.stdout.strip()) == (0, f"wayword {wayword.__version__}")
    assert "Examples" in cli("generate", "--help").stdout
    assert cli("generate", "--colour", "red").returncode == 2
    refused = cli("generate", "--platform", "matterport", "--data", tmp_path, "--out", tmp_path / "run")
    assert refused.returncode == 1 and refused.stderr.startswith("error: ") and "Traceback" not in refused.stderr


def test_results_go_to_standard_output_and_messages_do_not(cli, tmp_path):
    done = cli("generate", "--paths", 1, "--style", "r2r", "--out", tmp_path / "run", "--json")
    assert done.returncode == 0 and json.loads(done.stdout)["items"] == 1


@pytest.mark.parametrize("which", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_program_with_its_children(tmp_path, which):
    program = started("generate", "--platform", "process", "--data", slow_world(tmp_path), "--out", tmp_path / "run")
    assert wait_for(lambda: sleepers() != []), program.communicate(timeout=30)
    time.sleep(0.3)
    program.send_signal(which)
    time.sleep(0.3)
    program.send_signal(which)
    _, told = program.communicate(timeout=30)
    assert program.returncode == 6, told
    assert "interrupted" in told and "Traceback" not in told
    assert wait_for(lambda: sleepers() == [])


def test_children_end_when_the_program_is_killed(tmp_path):
    program = started("generate", "--platform", "process", "--data", slow_world(tmp_path), "--out", tmp_path / "run")
    assert wait_for(lambda: sleepers() != [])
    time.sleep(0.5)
    program.kill()
    program.communicate(timeout=30)
    assert wait_for(lambda: sleepers() == [])


def test_ctrl_c_inside_a_call_is_raised_and_the_same_call_goes_on(tmp_path):
    script = tmp_path / "interrupted.py"
    script.write_text(
        "import os, signal, sys, wayword\n"
        "def show(done, total, text):\n"
        "    if done >= 1 and not hit:\n"
        "        hit.append(1); os.kill(os.getpid(), signal.SIGINT)\n"
        "hit = []\n"
        "run = lambda: wayword.generate(sys.argv[1], paths=4, seed=5, style='r2r', progress=show)\n"
        "try:\n"
        "    run()\n"
        "except KeyboardInterrupt:\n"
        "    print('raised', len(wayword.load_run(sys.argv[1])) < 4)\n"
        "print(len(run()) + len(wayword.load_run(sys.argv[1]).rejected))\n"
    )
    done = subprocess.run(
        [sys.executable, script, tmp_path / "run"], capture_output=True, text=True, timeout=300, env=os.environ
    )
    assert done.stdout.splitlines() == ["raised True", "4"], done.stdout + done.stderr


def test_a_call_whose_child_hangs_is_ended_by_the_second_ctrl_c(tmp_path):
    script = tmp_path / "hung.py"
    script.write_text(
        "import signal, sys, threading, time, os, wayword\n"
        "def twice():\n"
        "    for _ in range(2):\n"
        "        time.sleep(2); os.kill(os.getpid(), signal.SIGINT)\n"
        "threading.Thread(target=twice, daemon=True).start()\n"
        "begin = time.time()\n"
        "try:\n"
        "    wayword.generate(sys.argv[2], platform='process', data=sys.argv[1], paths=1)\n"
        "except KeyboardInterrupt:\n"
        "    print('raised', time.time() - begin < 30)\n"
    )
    world = slow_world(tmp_path)
    done = subprocess.run(
        [sys.executable, script, world, tmp_path / "run"], capture_output=True, text=True, timeout=120
    )
    assert done.stdout.splitlines() == ["raised True"], done.stdout + done.stderr
    assert wait_for(lambda: sleepers() == [])


def ran_in_hall(folder, text):
    """Runs a script that can import the world of the tests; its argument is a folder for a run."""
    script = folder / "script.py"
    script.write_text(f"import sys; sys.path[:0] = {[str(HERE)]!r}\n" + text)
    return subprocess.run([sys.executable, script, folder / "run"], capture_output=True, text=True, timeout=120)


def test_the_interpreter_ends_while_another_thread_is_inside_a_call(tmp_path):
    done = ran_in_hall(
        tmp_path,
        "import threading, time, wayword\n"
        "from halls import Hall\n"
        "class Slow(Hall):\n"
        "    def observe(self, scene, look):\n"
        "        time.sleep(0.2)\n"
        "        return super().observe(scene, look)\n"
        "paths = dict(paths=50, hops=(2, 6), metres=(3, 14))\n"
        "make = lambda: wayword.generate(sys.argv[1], platform=Slow(), progress=False, **paths)\n"
        "threading.Thread(target=make, daemon=True).start()\n"
        "time.sleep(1.5)\n"
        "print('ends')\n",
    )
    assert (done.returncode, done.stdout) == (0, "ends\n"), done.stderr


def test_a_world_of_this_process_that_hangs_is_left_by_ctrl_c(tmp_path):
    done = ran_in_hall(
        tmp_path,
        "import os, signal, threading, time, wayword\n"
        "from halls import Hall\n"
        "class Hangs(Hall):\n"
        "    def scenes(self):\n"
        "        time.sleep(100)\n"
        "threading.Timer(1, os.kill, (os.getpid(), signal.SIGINT)).start()\n"
        "begin = time.time()\n"
        "try:\n"
        "    wayword.Follower(platform=Hangs()).scenes\n"
        "except KeyboardInterrupt:\n"
        "    print('raised', time.time() - begin < 30)\n"
        "print(wayword.Follower(platform=Hall()).scenes)\n",
    )
    assert done.stdout.splitlines() == ["raised True", "['hall']"], done.stdout + done.stderr
