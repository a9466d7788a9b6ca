/** Leaves: parts of triangles that are drawn in patterns of equal pieces. */

/** Numbers of one leaf: three vertices, halvings of the edges, second and third barycentric coordinates of three corners. */
export const LEAF_NUMBERS = 10;

/** A list of leaves that grows as it needs. */
export class Leaves {
    count = 0;
    numbers = new Float32Array(64 * LEAF_NUMBERS);

    clear() {
        this.count = 0;
    }

    /** Makes room for one more leaf, and returns where its numbers go. */
    add() {
        const at = this.count * LEAF_NUMBERS;
        if (at === this.numbers.length) {
            const larger = new Float32Array(2 * this.numbers.length);
            larger.set(this.numbers);
            this.numbers = larger;
        }
        this.count += 1;
        return at;
    }
}
