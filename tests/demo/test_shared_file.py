"""The file behind the web viewer: for the page that knows its address, and for nobody else."""

import http.client
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from swamp_rl.demo.shared_file import shared_file

PAGE = "http://127.0.0.1:9090"


def asked(address: str, path: str | None = None, **headers: str) -> http.client.HTTPResponse:
    place = urlsplit(address)
    connection = http.client.HTTPConnection(place.hostname or "", place.port)
    connection.request("GET", path or place.path, headers=headers)
    return connection.getresponse()


@pytest.fixture
def file(tmp_path: Path) -> Path:
    path = tmp_path / "demo.rrd"
    path.write_bytes(bytes(range(256)) * 4096)
    return path


def test_the_page_reads_the_whole_file(file: Path) -> None:
    with shared_file(file, PAGE) as address:
        answer = asked(address)
        assert answer.status == 200
        assert answer.headers["Access-Control-Allow-Origin"] == PAGE
        assert answer.read() == file.read_bytes()


@pytest.mark.parametrize("path", ["/", "/demo.rrd", "/../demo.rrd", "/%2e%2e/demo.rrd", "/%C3%A9"])
def test_without_its_address_the_file_is_not_found(file: Path, path: str) -> None:
    with shared_file(file, PAGE) as address:
        assert asked(address, path).status == 404


@pytest.mark.parametrize("host", ["evil.com", "127.0.0.1:80@evil.com", "localhost", "[::1]x", ""])
def test_a_request_by_another_name_of_the_machine_is_refused(file: Path, host: str) -> None:
    with shared_file(file, PAGE) as address:
        assert asked(address, Host=host).status == 403


def test_two_addresses_of_one_file_differ(file: Path) -> None:
    with shared_file(file, PAGE) as one, shared_file(file, PAGE) as other:
        assert urlsplit(one).path != urlsplit(other).path


def test_nothing_is_served_afterwards(file: Path) -> None:
    with shared_file(file, PAGE) as address:
        pass
    with pytest.raises(ConnectionRefusedError):
        asked(address)
