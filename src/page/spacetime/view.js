import { dot, scaled, sum } from "./vector.js";
// stub: objects at rest in the scene only
export function viewOf(moment, object) {
    return { offset: sum(moment.position, scaled(object.position, -1)), rapidity: moment.rapidity, direction: moment.direction, rotation: [0, 0, 0, 1] };
}
