-- A load for wrk, by the environment variable MIX: what it asks of the demo scene, and a summary as one line of JSON.
--   panoramas  a picture of another place each time: nothing is cached
--   cached     one picture again and again
--   numbers    the sky's numbers of another place each time
--   clicks     as people click: the site, then its sky, then its picture
--   tiles      map tiles of lights and ground
--   mixed      three clicks of ten on one of 200 places, five tiles of ten, two of ten the lists that clients read first
local mix = os.getenv("MIX") or "mixed"
local counter, thread_number = 0, 0

function setup(thread)
    thread:set("number", thread_number)
    thread_number = thread_number + 1
end

function init()
    math.randomseed(os.time() * 100 + (number or 0))
end

local function place()
    return string.format("lat=%.6f&lon=%.6f", 44.2 + 3.2 * math.random(), 6.2 + 6.2 * math.random())
end

local known = {}
local function known_place()
    if #known == 0 then
        math.randomseed(7)
        for i = 1, 200 do known[i] = place() end
        math.randomseed(os.time() * 100 + (number or 0))
    end
    return known[math.random(#known)]
end

local function tile(layer)
    local z = math.random(6, 9)
    local n = 2 ^ z
    local x = math.floor((6.5 + 5.5 * math.random() + 180) / 360 * n)
    local latitude = math.rad(44.5 + 2.5 * math.random())
    local y = math.floor((1 - math.log(math.tan(latitude) + 1 / math.cos(latitude)) / math.pi) / 2 * n)
    return string.format("/api/v1/scenes/demo/tiles/%s/%d/%d/%d.png", layer, z, x, y)
end

local demo = "/api/v1/scenes/demo/"
local asks = {
    panoramas = function() return demo .. "panorama.png?" .. place() end,
    cached = function() return demo .. "panorama.png?lat=46.17&lon=8.79" end,
    numbers = function() return demo .. "sky?" .. place() end,
    clicks = function()
        local step = counter % 3
        if step == 0 then clicked = place() end
        return demo .. ({ "site?", "sky?", "panorama.png?" })[step + 1] .. clicked
    end,
    tiles = function() return tile(math.random() < 0.5 and "radiance" or "elevation") end,
    mixed = function()
        local dice = math.random()
        if dice < 0.3 then
            return demo .. ({ "site?", "sky?", "panorama.png?" })[math.random(3)] .. known_place()
        elseif dice < 0.8 then
            return tile(math.random() < 0.5 and "radiance" or "elevation")
        end
        return ({ "/api/v1/scenes", "/api/v1/atmospheres", demo .. "places", "/" })[math.random(4)]
    end,
}

function request()
    local path = asks[mix]()
    counter = counter + 1
    return wrk.format("GET", path)
end

function done(summary, latency, requests)
    local refused = summary.errors.status
    io.write(string.format(
        '{"mix": "%s", "seconds": %.2f, "answers": %d, "per_second": %.1f, "p50_ms": %.2f, "p99_ms": %.2f, "most_ms": %.1f, "not_2xx": %d, "broken": %d}\n',
        mix, summary.duration / 1e6, summary.requests, summary.requests / summary.duration * 1e6,
        latency:percentile(50) / 1e3, latency:percentile(99) / 1e3, latency.max / 1e3, refused,
        summary.errors.connect + summary.errors.read + summary.errors.write + summary.errors.timeout))
end
