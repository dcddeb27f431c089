import socket

import pytest

from tsas_cli.reporting.viewer.child import LOOPBACK, free_ports
from tsas_cli.support.errors import InputError


def test_free_ports_are_free_and_no_two_are_the_same():
    ports = free_ports(5)
    assert len(set(ports)) == 5
    for port in ports:
        socket.create_server((LOOPBACK, port)).close()


def test_ports_asked_for_follow_each_other_up_to_the_last():
    first = next(p for p in iter(lambda: free_ports(1)[0], None) if p < 65000)
    assert free_ports(2, first) == (first, first + 1)
    with pytest.raises(InputError, match="port 65536"):
        free_ports(2, 65535)


@pytest.mark.parametrize("address", [LOOPBACK, "0.0.0.0"])  # noqa: S104 # by others
def test_a_port_in_use_is_refused_whoever_it_is_bound_to(address):
    with socket.create_server((address, 0)) as taken:
        port = taken.getsockname()[1]
        told = rf"^--port: port {port} cannot be had \(.*in use.*\); choose"
        with pytest.raises(InputError, match=told):
            free_ports(1, port)
