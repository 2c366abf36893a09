"""The local page: who may ask, what may be read, what is shown of values, what is saved."""

import asyncio
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import httpx
import numpy as np
import pytest

from seatsim.page.app import make_app, open_target
from seatsim.page.scenario_view import Choice, Slider, View, read_number
from seatsim.report.blocks import Table
from seatsim.report.packing import Panel, pack_signals
from seatsim.scenario.loading import EXAMPLES, load, single
from seatsim.schema.content import plain
from seatsim.schema.errors import InputError

TOKEN, PORT = "a-token", 8123
HOME = f"http://127.0.0.1:{PORT}"


class Plain:
    """A target that simulates nothing."""

    name = "</script><script>alert(1)</script>"
    sliders = (Slider("mass", "Driver mass", "kg", 30.0, 150.0, 80.0),)
    choices = (Choice("law", "Controller", [("file", "as in the file"), ("off", "no current")]),)

    def show(self, request):
        mass, time = read_number(request, self.sliders[0]), np.arange(10.0)
        panel = Panel("damper_force", "N", {"": [mass * time]})
        signals = pack_signals("", [("as set", 0)], {"": time}, [panel])
        return View(f"{mass:g} kg <b>", [Table("t", ["a", "b"], [["<i>", f"{mass:g}"]])], signals)

    def encode(self, request):
        return plain(dict(load("road-b")[0].source.data))


class Endless(Plain):
    """A target that computes until it is stopped, as the design of a law may."""

    def show(self, request):
        while request.get("mass") == 95.0:
            pass
        return super().show(request)


@pytest.fixture
def app(tmp_path):
    return make_app(Plain(), tmp_path, TOKEN, PORT)


def ask(app, method, path, token=TOKEN, base=HOME, **options):
    """Return the answer to one request."""

    async def send():
        cookies = {f"seatsim-{PORT}": token} if token else {}
        transport = httpx.ASGITransport(app=app)
        async with httpx.AsyncClient(transport=transport, base_url=base, cookies=cookies) as client:
            return await client.request(method, path, **options)

    return asyncio.run(send())


def test_a_page_keeps_its_cookie_when_another_port_is_opened(app, tmp_path):
    other = make_app(Plain(), tmp_path, "other-token", PORT + 1)
    pages = ((app, TOKEN, HOME), (other, "other-token", f"http://127.0.0.1:{PORT + 1}"))
    opened = [ask(page, "GET", f"/?token={token}", token="", base=base) for page, token, base in pages]
    jar = "; ".join(answer.headers["set-cookie"].partition(";")[0] for answer in opened)
    for page, _, base in pages:
        assert ask(page, "GET", "/", token="", base=base, headers={"cookie": jar}).status_code == 200


def test_a_token_opens_the_page_and_leaves_the_address(app):
    for path, token in (("/", ""), ("/", "another"), ("/?token=another", "")):
        assert ask(app, "GET", path, token=token).status_code == 403
    opened = ask(app, "GET", f"/?token={TOKEN}", token="")
    assert opened.status_code == 303 and opened.headers["location"] == "/"
    assert "HttpOnly" in opened.headers["set-cookie"] and "SameSite=strict" in opened.headers["set-cookie"]
    page = ask(app, "GET", "/")
    assert page.status_code == 200 and "default-src 'none'" in page.headers["content-security-policy"]
    assert "<script>alert" not in page.text and "80 kg &lt;b&gt;" in page.text


def test_a_foreign_host_or_origin_is_refused(app):
    hosts = ("evil.example", f"evil.example:{PORT}", "127.0.0.1:1", f"[::1]:{PORT}", "")
    origins = ("http://evil.example", "null", f"https://127.0.0.1:{PORT}", "http://127.0.0.1")
    for headers in (*({"host": host} for host in hosts), *({"origin": origin} for origin in origins)):
        assert ask(app, "POST", "/view", json={}, headers=headers).status_code == 403, headers
    assert ask(app, "POST", "/view", json={}, headers={"origin": HOME}).status_code == 200


def test_a_target_that_is_not_there_is_said(tmp_path):
    with pytest.raises(InputError, match="no such file"):
        open_target(tmp_path / "none.yaml")


def test_large_requests_are_refused(app):
    assert ask(app, "POST", "/view", json={"x": "y" * 200_000}).status_code == 413


def test_values_are_shown_and_wrong_ones_are_said(app):
    found = ask(app, "POST", "/view", json={"mass": 95.0}).json()
    assert found["answer"] == "95 kg <b>" and "&lt;i&gt;" in found["tables"] and found["signals"]["panels"]
    wrong = ask(app, "POST", "/view", json={"mass": 1e9})
    assert wrong.status_code == 422 and "30 to 150 kg" in wrong.json()["error"]
    for content, kind in ((b"{", "application/json"), (b"{}", "text/plain")):
        assert ask(app, "POST", "/view", content=content, headers={"content-type": kind}).status_code == 422
    assert ask(app, "GET", "/view").status_code == 405


def test_what_takes_long_is_stopped_and_the_page_goes_on(tmp_path):
    app = make_app(Endless(), tmp_path, TOKEN, PORT)
    with ThreadPoolExecutor(1) as pool:
        endless = pool.submit(ask, app, "POST", "/view", json={"mass": 95.0})
        while not endless.done():
            assert ask(app, "POST", "/stop").status_code == 200
    assert endless.result().status_code == 422 and "stopped" in endless.result().json()["error"]
    assert ask(app, "POST", "/view", json={"mass": 80.0}).json()["answer"] == "80 kg <b>"


def test_a_scenario_is_saved_once_under_a_plain_name(tmp_path, app):
    assert ask(app, "POST", "/save", json={"name": "mine"}).json() == {"saved": "mine.yaml"}
    assert single(tmp_path / "mine.yaml").name == "mine"
    assert "not replaced" in ask(app, "POST", "/save", json={"name": "mine"}).json()["error"]
    for name in ("../mine", "", "a/b", ".hidden"):
        assert ask(app, "POST", "/save", json={"name": name}).status_code == 422
    assert [path.name for path in tmp_path.iterdir()] == ["mine.yaml"]


@pytest.fixture(scope="module")
def road():
    """The page's view of a scenario, which keeps nothing of what is asked."""
    return open_target(Path("road-b"))


@pytest.fixture(scope="module")
def recorded():
    """That of a recording."""
    return open_target(next(path for path in EXAMPLES if path.is_dir()) / "data" / "recording")


def test_a_scenario_follows_what_is_moved(road):
    changed = road.choose({"mass": 95.0, "road": "C", "law": "off"})
    assert changed.plant.driver_mass == 95.0 and changed.excitation.road_class == "C"
    assert changed.excitation.duration == 20.0 and changed.title.endswith("(off)")
    assert road.encode({"mass": 95.0})["plant"]["driver_mass"] == 95.0


def test_the_numbers_of_the_law_at_work_can_be_moved(road):
    request = {"road": "C", "law": "skyhook"}
    [damping] = road.show(request).gains
    assert (damping.name, damping.unit, damping.value, damping.high) == ("damping", "N·s/m", 2000.0, 6000.0)
    moved = road.choose({**request, "gains": {"damping": 500.0}})
    assert moved.control.law.damping == 500.0 and moved.excitation.road_class == "C"
    assert road.encode({**request, "gains": {"damping": 500.0}})["controller"]["damping"] == 500.0
    with pytest.raises(InputError, match="0 to 6000"):
        road.choose({**request, "gains": {"damping": 1e9}})


def test_a_temperature_without_effect_has_no_slider(road):
    assert [slider.name for slider in road.sliders] == ["mass"]
    names = [slider.name for slider in open_target(Path("temperature-sweep")).sliders]
    assert names == ["mass", "temperature"]


RUBS = {"damper.seal_friction": {"force": 60.0}}


def test_a_fit_finds_the_effect_that_the_recording_holds(recorded):
    fitted = recorded.show({"effects": RUBS, "fit": True})
    assert fitted.fitted["damper.seal_friction"]["force"] < 60.0
    views = recorded.show({}), fitted, recorded.show({"effects": fitted.fitted})
    before, after, shown = (each.tables[0].rows for each in views)
    assert [row[1] for row in after] == [row[1] for row in before] and shown == after


def test_an_effect_that_is_not_there_makes_the_gap_grow(recorded):
    before, after = recorded.show({}), recorded.show({"effects": RUBS})
    assert before.answer.startswith("The nominal simulation is off by") and "grows" in after.answer
    # What a slider shows in millimetres is stated in metres.
    assert {slider.unit for switch in recorded.switches for slider in switch.sliders} & {"m", "mm"} == {"mm"}
    saved = recorded.encode({"effects": {"damper.seal_friction": {"force": 60.0, "presliding": 0.5}}})["effects"][-1]
    assert saved["parameters"]["presliding"] == pytest.approx(5e-4)
    assert saved["effect"] == "damper.seal_friction" and saved["parameters"]["force"] == 60.0
    with pytest.raises(InputError, match="no effect"):
        recorded.show({"effects": {"damper.none": {}}})
