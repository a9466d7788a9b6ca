/** The page at work: the parts put together, and the loop of frames. */

import { Gamepads, padsOf } from "./controls/gamepad.js";
import { Keyboard } from "./controls/keyboard.js";
import { lookOf, rotationOfLook, turnedLook } from "./controls/look.js";
import { mouseLook } from "./controls/mouse.js";
import { Pilot } from "./controls/pilot.js";
import { Touch } from "./controls/touch.js";
import { headKeys, outsideKeys } from "./controls/view_keys.js";
import { whiteAt } from "./effects/colors.js";
import { orientationOf, setRapidity, velocityOf } from "./spacetime/moment.js";
import { rotate } from "./spacetime/quaternion.js";
import { firstState, Store } from "./state.js";
import { words } from "./texts.js";
import { copy, save } from "./ui/clipboard.js";
import { exportCommand, renderCommand } from "./ui/command.js";
import { Diagram } from "./ui/diagram.js";
import { FilmBar } from "./ui/film_bar.js";
import { Help } from "./ui/help.js";
import { Instruments } from "./ui/instruments.js";
import { Layout } from "./ui/layout.js";
import { rampLegend } from "./ui/legend.js";
import { readLink, writeLink } from "./ui/link.js";
import { Panel } from "./ui/panel.js";
import { Shell } from "./ui/shell.js";
import { Toast } from "./ui/toast.js";
import { Views } from "./views/views.js";
import { Vr } from "./vr/vr.js";

/** A screen narrower than this, in CSS pixels, has the panel closed at first. */
const WIDE = 900;

/** The widest and the narrowest vertical field of view in degrees. */
const WIDEST = 150;
const NARROWEST = 2;

/** Milliseconds between two writings of the address. */
const ADDRESS_MS = 1000;

/** Radians that a gamepad turns the head by in a second. */
const HEAD_RATE = 1.5;

/** Things within this angle of a direction, in radians, are looked at as they pass, in such a field of view in degrees. */
const PASSING_ANGLE = 0.8;
const PASSING_FIELD_DEG = 40;

export class Viewer {
    store;
    views;
    world;
    /** How many frames there were. */
    frames = 0;

    #data;
    #pilot;
    #gamepads;
    #vr;
    #layout;
    #instruments;
    #panel;
    #diagram;
    #filmBar;
    #toast = new Toast();
    #last = 0;
    #isStale = true;
    #isFramed = false;
    /** Whether the head follows what passes, as long as nobody turns it. */
    #isFollowing;

    /**
     * @param {import("./data.js").PageData} data
     * @param {import("./surface/world.js").World} world With its meshes loaded.
     * @param {{ canvas: HTMLCanvasElement, observer: HTMLElement, outside: HTMLElement, root: HTMLElement }} page
     */
    constructor(data, world, page) {
        this.#data = data;
        this.world = world;
        this.views = new Views(page.canvas, world, page.outside, { background: data.background, size: world.size });
        this.#layout = new Layout(page.canvas, page.observer, page.outside);
        const shell = new Shell(page.root, data.title, {
            onPanel: () => shell.showPanel(!document.body.classList.contains("with-panel")),
            onHelp: () => this.store.change({ help: !this.store.state.help }),
        });
        shell.showPanel(globalThis.innerWidth >= WIDE);

        /** @param {import("./controls/input.js").Action} action */
        const act = (action) => this.#act(action);
        this.#vr = new Vr(this.views.renderer, navigator.xr, (reason) => this.#toast.show(reason));
        this.#gamepads = new Gamepads(() => padsOf(navigator), act);
        this.#pilot = new Pilot(data, world.size, [
            new Keyboard(globalThis.window, act),
            this.#gamepads,
            new Touch(shell.thrust, shell.turn, shell.brake),
            this.#vr,
        ]);
        this.#pilot.reset();
        const { film } = this.#pilot;
        const link = readLink(location.hash, data.observer);
        this.#isFollowing = this.#passes();
        this.store = new Store({
            ...firstState(data, this.#pilot.timeScale),
            look: lookOf(data.camera.look),
            film: film.isLong && !link.moment,
            ...(this.#isFollowing && { fieldOfViewDeg: PASSING_FIELD_DEG }),
            ...link.state,
        });
        this.#pilot.moment = link.moment ?? film.moment;
        this.#look(page.observer);

        this.#instruments = new Instruments();
        this.#panel = new Panel(
            this.store,
            {
                reset: () => this.#act("reset"),
                playFilm: () => this.#playFilm(),
                setRapidity: (rapidity) => {
                    this.store.change({ film: false });
                    this.moment = setRapidity(this.moment, rapidity);
                },
                setSearchlight: (isOn) => this.#setSearchlight(isOn),
                copyLink: () =>
                    this.#copy(`${location.href.split("#")[0]}#${writeLink(this.moment, this.store.state)}`),
                copyRender: () => this.#copy(this.renderCommand()),
                copyExport: () => this.#copy(exportCommand(this.#data, this.moment, this.store.state)),
                savePicture: () => this.#savePicture(),
            },
            { timeScale: this.#pilot.timeScale, hasFilm: film.isLong, extra: [this.#vr.button] },
        );
        this.#filmBar = film.isLong ? this.#newFilmBar() : null;
        this.#diagram = new Diagram(shell.diagram, data.objects, world.size);
        const help = new Help(() => this.store.change({ help: false }));
        const legend = rampLegend(data.colors.ramp);
        shell.dashboard.append(this.#instruments.element, ...(this.#filmBar ? [this.#filmBar.element] : []), legend);
        page.root.append(this.#panel.element, help.element, this.#toast.element);

        this.#subscribe(shell, help, legend);
        this.#greet(page.canvas);
        this.views.outside.onChange(() => this.#makeStale());
        outsideKeys(page.outside, this.views.outside);
        setInterval(() => this.#keepAddress(), ADDRESS_MS);
        page.outside.addEventListener("dblclick", () => {
            this.#isFramed = false;
            this.#makeStale();
        });
        new ResizeObserver(() => {
            this.#layout.resized();
            this.#makeStale();
        }).observe(page.canvas);
    }

    /** What the observer is now. */
    get moment() {
        return this.#pilot.moment;
    }

    set moment(moment) {
        this.#pilot.moment = moment;
        this.#makeStale();
    }

    /** Begins to draw, frame after frame. */
    start() {
        this.views.renderer.setAnimationLoop((now) => this.frame(now));
    }

    /**
     * Flies and draws a frame.
     * @param {number} now In milliseconds.
     */
    frame(now) {
        const { state } = this.store;
        const before = this.moment;
        const last = this.#last;
        this.#last = now;
        if (this.#pilot.frame((now - last) / 1000, state)) {
            this.store.change({ film: false, paused: false });
        }
        if (state.film && this.#pilot.film.isAtEnd && !state.paused) {
            this.store.change({ paused: true });
        }
        this.#turnHead((now - last) / 1000);
        this.#follow();
        if (this.#vr.isPresenting) {
            this.views.drawInHeadset(this.moment);
            this.#isStale = true;
        } else if (this.moment !== before || this.#isStale) {
            this.#isStale = false;
            this.drawNow(now);
        }
        this.frames += 1;
    }

    /**
     * Draws the moment.
     * @param {number} [now] In milliseconds.
     */
    drawNow(now = performance.now()) {
        const { width, height, rectangles } = this.#layout.place();
        this.views.resize(width, height);
        if (rectangles.outside && !this.#isFramed) {
            this.#isFramed = true;
            const { rapidity, direction } = velocityOf(this.moment);
            const ahead = rapidity > 0 ? direction : rotate(orientationOf(this.moment), [0, 0, -1]);
            this.views.outside.frame(this.world.nearestSeen(this.moment), ahead, rectangles.outside);
        }
        this.views.draw(this.moment, rectangles);
        const isRead = this.#instruments.show(this.moment, this.#data.observer.position, now);
        this.#panel.showSpeed(velocityOf(this.moment).rapidity);
        this.#filmBar?.show();
        this.#diagram.record(this.moment);
        const isDrawn = !this.store.state.diagram || this.#diagram.show(this.moment, now);
        // Readings are taken some times a second: the last ones are taken too.
        this.#isStale ||= !isRead || !isDrawn;
    }

    /** The command line that draws the observer's view of this moment. */
    renderCommand() {
        const { rectangles } = this.#layout.place();
        const ratio = this.views.renderer.getPixelRatio();
        const { width, height } = rectangles.observer ?? { width: 1280, height: 720 };
        return renderCommand(this.#data, this.moment, this.store.state, {
            width: width * ratio,
            height: height * ratio,
        });
    }

    #makeStale() {
        this.#isStale = true;
    }

    /**
     * @param {Shell} shell
     * @param {Help} help
     * @param {HTMLElement} legend
     */
    #subscribe(shell, help, legend) {
        const { store, world, views } = this;
        store.subscribe(["layout"], (state) => this.#layout.show(state.layout));
        store.subscribe(["model", "doppler", "searchlight", "exposure"], (state) => world.setLook(state.model, state));
        store.subscribe(["ghostAtRest"], (state) => world.setGhost("rest", state.ghostAtRest));
        store.subscribe(["ghostContracted"], (state) => world.setGhost("contracted", state.ghostContracted));
        store.subscribe(["fieldOfViewDeg"], (state) => {
            views.fieldOfViewDeg = state.fieldOfViewDeg;
        });
        store.subscribe(["look"], (state) => views.look(rotationOfLook(state.look)));
        store.subscribe(["help"], (state) => help.show(state.help));
        store.subscribe(["diagram"], (state) => {
            shell.diagram.hidden = !state.diagram;
        });
        store.subscribe(["doppler"], (state) => {
            legend.hidden = state.doppler !== "ramp";
        });
        store.subscribe(["film", "paused"], (state) => {
            if (this.#filmBar) {
                this.#filmBar.element.hidden = !state.film;
                this.#filmBar.showPlaying(!state.paused);
            }
        });
        store.subscribe(
            ["layout", "model", "doppler", "searchlight", "exposure", "ghostAtRest", "ghostContracted"],
            () => this.#makeStale(),
        );
        store.subscribe(["fieldOfViewDeg", "look", "diagram", "paused", "film"], () => this.#makeStale());
    }

    /** @param {HTMLElement} element The element over the observer's view. */
    #look(element) {
        const { store } = this;
        /** @param {[number, number]} change */
        const turn = (change) => {
            this.#isFollowing = false;
            store.change({ look: turnedLook(store.state.look, change) });
        };
        headKeys(document.body, turn);
        mouseLook(element, {
            fieldOfViewDeg: () => store.state.fieldOfViewDeg,
            turn,
            center: () => store.change({ look: [0, 0] }),
            zoom: (factor) => {
                const next = store.state.fieldOfViewDeg * factor;
                store.change({ fieldOfViewDeg: Math.min(Math.max(next, NARROWEST), WIDEST) });
            },
        });
    }

    /** @param {import("./controls/input.js").Action} action */
    #act(action) {
        const { store } = this;
        if (action === "pause") {
            this.#pause(!store.state.paused);
        } else if (action === "help") {
            store.change({ help: !store.state.help });
        } else {
            this.#pilot.reset();
            this.#diagram.clear();
            this.#isFollowing = this.#passes();
            store.change({ paused: false, look: lookOf(this.#data.camera.look), film: this.#pilot.film.isLong });
            this.#makeStale();
        }
    }

    /** @param {boolean} isPaused */
    #pause(isPaused) {
        if (!isPaused && this.store.state.film && this.#pilot.film.isAtEnd) {
            this.#pilot.film.seek(this.#pilot.film.from);
        }
        this.store.change({ paused: isPaused });
    }

    /**
     * The searchlight effect, exposed so that a white surface straight ahead is as bright as at rest.
     * @param {boolean} isOn
     */
    #setSearchlight(isOn) {
        const { rapidity } = velocityOf(this.moment);
        const { brightness } = whiteAt(this.#data.colors.white, rapidity / Math.LN2);
        this.store.change({ searchlight: isOn, exposure: isOn ? Math.max(Math.round(-brightness * 4) / 4, -12) : 0 });
    }

    #playFilm() {
        this.#pilot.film.seek(this.#pilot.film.from);
        this.store.change({ film: true, paused: false });
    }

    #newFilmBar() {
        const { film } = this.#pilot;
        return new FilmBar(film, this.#data.steps, {
            play: (isPlaying) => this.#pause(!isPlaying),
            seek: (properTime) => {
                film.seek(properTime);
                this.store.change({ paused: true });
                this.moment = film.moment;
            },
        });
    }

    /** Says how to begin, and what the page does not show. @param {HTMLCanvasElement} canvas */
    #greet(canvas) {
        const isTouch = matchMedia("(pointer: coarse)").matches;
        this.#toast.show(this.#data.lamps > 0 ? words.noLamps : isTouch ? words.hintTouch : words.hint, 8000);
        canvas.addEventListener("webglcontextlost", () => this.#toast.show(words.contextLost, 60_000));
        canvas.addEventListener("webglcontextrestored", () => {
            this.#toast.show(words.contextBack);
            this.#makeStale();
        });
    }

    /** Whether the film of the scene shows things that pass an observer who coasts. */
    #passes() {
        const { film } = this.#pilot;
        return this.#data.flight.length === 0 && film.isLong && this.world.partOfSky(film.moment).angle < PASSING_ANGLE;
    }

    /** Looks at what passes while the film of an observer who coasts is shown. */
    #follow() {
        if (this.#isFollowing && this.store.state.film) {
            this.store.change({ look: lookOf(this.world.partOfSky(this.moment).middle) });
        }
    }

    /**
     * Turns the head as the right stick of a gamepad asks.
     * @param {number} seconds
     */
    #turnHead(seconds) {
        const [left, up] = this.#gamepads.look;
        if (left !== 0 || up !== 0) {
            const turn = HEAD_RATE * Math.min(seconds, 0.1);
            this.store.change({ look: turnedLook(this.store.state.look, [left * turn, up * turn]) });
        }
    }

    /** Keeps what is shown in the address, but for the film. */
    #keepAddress() {
        const fragment = this.store.state.film ? "" : `#${writeLink(this.moment, this.store.state)}`;
        if (fragment !== location.hash) {
            history.replaceState(null, "", fragment || location.href.split("#")[0]);
        }
    }

    /** @param {string} text */
    async #copy(text) {
        this.#toast.show((await copy(text)) ? words.copied : words.notCopied);
    }

    async #savePicture() {
        this.drawNow();
        save(await this.views.picture(), "photosurface.png");
    }
}
