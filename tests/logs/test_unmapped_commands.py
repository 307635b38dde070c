"""Commands of the boat that a table has and its mapping leaves out."""

from pathlib import Path

from tests.support.command_line import Call
from tests.support.command_line import call as call  # the fixture
from tests.support.from_scratch import written


def test_commands_in_the_log_that_the_mapping_leaves_out_are_reported(call: Call, tmp_path: Path) -> None:
    boat = written(tmp_path, "twin")
    rows = (f"{0.1 * i:.1f},{i},0,0,{i % 3 / 3},{i % 5 / 5}\n" for i in range(50))
    Path("log.csv").write_text("".join(["t,n,e,h,throttle_port,throttle_starboard\n", *rows]))
    words = ["runs", "import", "log.csv", "--boat", boat]
    words += ["--map", "time=t", "--map", "north=n", "--map", "east=e", "--map", "heading=h"]
    message = "missing: throttle_port, throttle_starboard of"
    code, text, complaint = call(*words, "--out", "without")
    assert code == 0 and message in text + complaint
    assert "give --map throttle_port=throttle_port" in text + complaint
    both = [f"--map=throttle_{side}=throttle_{side}" for side in ("port", "starboard")]
    code, text, complaint = call(*words, *both, "--out", "with")
    assert code == 0 and "missing" not in text + complaint
